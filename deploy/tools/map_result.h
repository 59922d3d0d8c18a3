// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "server/map_server.h"
#include "server/store/map_file.h"

namespace coslam {

// The map of a file.
MapServer load_map(const MapFile& file);

// Writes the paths and points of a map file as a RESULT. Throws UserError when the folder holds a run, or when the file
// cannot be read.
void write_map_result(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace coslam
