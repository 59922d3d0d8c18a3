// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>
#include <vector>

#include "common/dataset/result.h"
#include "common/dataset/sequence.h"

// A map of a result in the forms of other programs. All throw UserError and return the files that were written.
namespace coslam::exporting {

using Files = std::vector<std::filesystem::path>;
using MapExport = std::function<Files(const ResultMap& map, const std::filesystem::path& folder)>;

Files export_tum(const ResultMap& map, const std::filesystem::path& folder);    // <agent>.tum
Files export_euroc(const ResultMap& map, const std::filesystem::path& folder);  // <agent>.csv: ns, p, q (w first)
Files export_kitti(const ResultMap& map, const std::filesystem::path& folder);  // <agent>.txt: 3x4, camera to world
Files export_ply(const ResultMap& map, const std::filesystem::path& folder);    // map.ply

// Text model of COLMAP (cameras.txt, images.txt, points3D.txt): the images of tracks/<agent>.csv, named
// <agent>/<6-digit frame>.png, and the static points that two of them see, adjusted once more as what they are
// (colmap_adjust.h). The sequence gives the cameras.
Files export_colmap(const ResultMap& map, const Sequence& sequence, const std::filesystem::path& folder);
// The same of pinhole cameras in sparse/, with their images in images/ and what dense stereo needs in stereo/. The
// sequence gives the images too.
Files export_colmap_undistorted(const ResultMap& map, const Sequence& sequence, const std::filesystem::path& folder);

// run.mcap: the run as a viewer would have seen it live (docs/live.md), all maps of it.
Files export_mcap(const ResultContents& contents, const std::filesystem::path& folder);
// The same, its octets in order.
void write_mcap(const ResultContents& contents, const std::function<void(std::string_view)>& out);

// Each map by itself: the common one into `folder`, others into maps/<ID> of it.
Files export_maps(const ResultContents& contents, const std::filesystem::path& folder, const MapExport& as);

}  // namespace coslam::exporting
