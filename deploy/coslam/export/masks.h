// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "deploy/coslam/export/colmap_model.h"

namespace coslam::exporting {

// Writes what moves in each image of a model of pinholes, as COLMAP takes it: <folder>/<image>.png, white but for black
// areas round moving points, those of one object in one area. False: nothing moved, and nothing is written. Throws
// UserError.
bool write_masks(const ResultFolder& result, const ColmapModel& model, const std::filesystem::path& folder);

}  // namespace coslam::exporting
