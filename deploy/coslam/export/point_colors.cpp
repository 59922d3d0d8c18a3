// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/point_colors.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "common/base/error.h"
#include "common/image/image_file.h"

namespace coslam::exporting {
namespace {

cv::Vec3b color_at(const cv::Mat& image, const Eigen::Vector2d& px) {
  const int x = std::clamp(static_cast<int>(std::lround(px.x())), 0, image.cols - 1);
  const int y = std::clamp(static_cast<int>(std::lround(px.y())), 0, image.rows - 1);
  return image.channels() == 3 ? image.at<cv::Vec3b>(y, x) : cv::Vec3b::all(image.at<std::uint8_t>(y, x));
}

}  // namespace

void PointColors::add(const cv::Mat& image, const ColmapModel::Image& seen) {
  for (const auto& o : seen.observations) {
    if (o.point == PointId()) continue;
    Sum& sum = sums_[o.point];
    sum.bgr += cv::Vec3d(color_at(image, o.px));
    ++sum.images;
  }
}

void PointColors::give(ColmapModel* model) const {
  for (const auto& [id, sum] : sums_) {
    auto& rgb = model->points.at(id).rgb;
    for (int i = 0; i < 3; ++i)
      rgb[static_cast<std::size_t>(i)] = cv::saturate_cast<std::uint8_t>(sum.bgr[2 - i] / sum.images);
  }
}

void write_image(const std::filesystem::path& file, const cv::Mat& image) {
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  if (error || !write_image_file(file, image)) throw UserError(file.string() + ": the image cannot be written");
}

void see_images(const ColmapModel& model, std::size_t camera, const CameraModel& lens, double rate_hz,
                const std::function<void(const ColmapModel::Image&, const cv::Mat&)>& visit) {
  std::map<FrameId, const ColmapModel::Image*> images;
  std::set<FrameId> frames;
  for (const auto& image : model.images) {
    if (image.camera != camera) continue;
    images.emplace(image.frame, &image);
    frames.insert(image.frame);
  }
  PlayedImages(model.cameras[camera].agent, rate_hz, lens).each(frames, [&](FrameId frame, const cv::Mat& image) {
    visit(*images.at(frame), image);
  });
}

}  // namespace coslam::exporting
