// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

namespace coslam {

// Folder for data that can be made again: $COSLAM_CACHE or ~/.cache/coslam; empty without either.
std::optional<std::filesystem::path> cache_folder();

}  // namespace coslam
