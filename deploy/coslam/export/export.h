// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>
#include <vector>

#include "common/dataset/result.h"
#include "common/dataset/sequence.h"
#include "deploy/coslam/export/colmap_model.h"

// A map of a result in the forms of other programs. All throw UserError and return the files that were written.
namespace coslam::exporting {

using Files = std::vector<std::filesystem::path>;
using MapExport = std::function<Files(const ResultMap& map, const std::filesystem::path& folder)>;

Files export_tum(const ResultMap& map, const std::filesystem::path& folder);    // <agent>.tum
Files export_euroc(const ResultMap& map, const std::filesystem::path& folder);  // <agent>.csv: ns, p, q (w first)
// <agent>.txt: 3x4, camera to world, a line for each pose; <agent>.times.txt: their times in seconds.
Files export_kitti(const ResultMap& map, const std::filesystem::path& folder);
// Names the gaps between the poses of agents, in words; empty: there are none.
std::string gaps_of(const ResultMap& map);

Files export_ply(const ResultMap& map, const std::filesystem::path& folder);  // map.ply
// Like export_ply(), with the colours that the images of the sequence have there.
Files export_ply_in_colour(const ResultMap& map, const Sequence& sequence, const std::filesystem::path& folder);

// Text model of COLMAP (cameras.txt, images.txt, points3D.txt): one of so many images that have a pose, and the static
// points that two of them see, adjusted once more as what they are (colmap_adjust.h). Images are named as the files of
// the sequence, from the folder that has them all; where it has no files <agent>/<6-digit frame>.png. Tracks are kept
// of every tenth image: between these, images have a pose alone.
struct ColmapOptions {
  int every = kTracksOfEvery;  // 1, 2, 5 or a multiple of 10
};
Files export_colmap(const ResultMap& map, const Sequence& sequence, const std::filesystem::path& folder,
                    const ColmapOptions& options);
// Like export_colmap(), of pinhole cameras in sparse/, with their images in images/, what dense stereo needs in stereo/
// and, where something moves, masks/<image>.png, black where that is. The sequence gives the images too.
Files export_colmap_undistorted(const ResultMap& map, const Sequence& sequence, const std::filesystem::path& folder,
                                const ColmapOptions& options);

// run.mcap: the run as a viewer would have seen it live (docs/live.md), all maps of it.
Files export_mcap(const ResultContents& contents, const std::filesystem::path& folder);
// Writes the content of run.mcap, its octets in order.
void write_mcap(const ResultContents& contents, const std::function<void(std::string_view)>& out);

// Each map by itself: the common one into `folder`, others into maps/<ID> of it.
Files export_maps(const ResultContents& contents, const std::filesystem::path& folder, const MapExport& export_map);

}  // namespace coslam::exporting
