// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>

#include "server/estimator/map_server.h"
#include "server/keep/store/map_file.h"

namespace coslam {

// Row number for MapFile::for_each_row() that stands for the end.
inline constexpr std::int64_t kLastRow = std::numeric_limits<std::int64_t>::max();

// The map of a file.
MapServer load_map(const MapFile& file);

// Writes the paths and points of the map file `path` as a RESULT. Throws UserError when the folder holds a run, or when
// the file cannot be read.
void write_map_result(const std::filesystem::path& path, const std::filesystem::path& folder);

}  // namespace coslam
