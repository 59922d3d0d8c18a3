// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/dataset/result.h"
#include "common/dataset/sequence.h"

// A result in the forms of other programs. All throw UserError and return the files that were written.
namespace coslam::exporting {

using Files = std::vector<std::filesystem::path>;

// Agents that have a trajectory in the result, by name.
std::vector<std::string> agents_of(const ResultFolder& result);

Files export_tum(const ResultFolder& result, const std::filesystem::path& folder);    // <agent>.tum
Files export_euroc(const ResultFolder& result, const std::filesystem::path& folder);  // <agent>.csv: ns, p, q (w first)
Files export_kitti(const ResultFolder& result,
                   const std::filesystem::path& folder);                            // <agent>.txt: 3x4, camera to world
Files export_ply(const ResultFolder& result, const std::filesystem::path& folder);  // map.ply

// Text model of COLMAP (cameras.txt, images.txt, points3D.txt): the images of tracks/<agent>.csv, named
// <agent>/<6-digit frame>.png, and the static points that two of them see. The sequence gives the cameras.
Files export_colmap(const ResultFolder& result, const Sequence& sequence, const std::filesystem::path& folder);

}  // namespace coslam::exporting
