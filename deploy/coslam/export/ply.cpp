// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/base/error.h"
#include "deploy/coslam/export/export.h"
#include "deploy/coslam/export/point_colors.h"

namespace coslam::exporting {
namespace {

std::filesystem::path ply_in(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw UserError(folder.string() + ": cannot be made: " + error.message());
  return folder / "map.ply";
}

}  // namespace

Files export_ply(const ResultMap& map, const std::filesystem::path& folder) {
  if (!std::filesystem::exists(map.folder.map())) throw UserError(map.folder.map().string() + ": there is no such map");
  const std::filesystem::path file = ply_in(folder);
  std::error_code error;
  std::filesystem::copy_file(map.folder.map(), file, std::filesystem::copy_options::overwrite_existing, error);
  if (error) throw UserError(file.string() + ": cannot be written: " + error.message());
  return {file};
}

Files export_ply_in_colour(const ResultMap& map, const Sequence& sequence, const std::filesystem::path& folder) {
  ColmapModel model = read_colmap_model(map, sequence);
  PointColors colors;
  for (std::size_t c = 0; c < model.cameras.size(); ++c) {
    see_images(model, c, model.cameras[c].model, sequence.rate_hz,
               [&](const ColmapModel::Image& image, const cv::Mat& taken) { colors.add(taken, image); });
  }
  colors.give(&model);
  std::vector<ResultPoint> points = read_points(map.folder.points());
  for (ResultPoint& point : points) {
    const auto seen = model.points.find(point.id);
    if (seen != model.points.end()) point.rgb = seen->second.rgb;
  }
  const std::filesystem::path file = ply_in(folder);
  write_ply(file, points, map.unit);
  return {file};
}

}  // namespace coslam::exporting
