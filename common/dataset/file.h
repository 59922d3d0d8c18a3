// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>

namespace coslam {

// Opens a file for writing, its folders created. Throws UserError.
std::ofstream create_file(const std::filesystem::path& file, std::ios::openmode mode = std::ios::out);
// Throws UserError when something written to the file did not get there.
void close_file(std::ofstream& stream, const std::filesystem::path& file);

}  // namespace coslam
