// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/undistort.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/base/error.h"
#include "deploy/coslam/export/point_colors.h"

namespace coslam::exporting {
namespace {

CameraModel pinhole(const CameraModel& lens, int half_width_px, int half_height_px) {
  return {2 * half_width_px,    2 * half_height_px,     lens.fx, lens.fy, half_width_px - 0.5,
          half_height_px - 0.5, DistortionModel::kNone, {}};
}

Eigen::Vector2d raw_of(const CameraModel& lens, const CameraModel& pinhole, const Eigen::Vector2d& px) {
  return lens.pixel_from_normalized(lens.distort_normalized(pinhole.normalized_from_pixel(px)));
}

// Beyond its valid field a lens model folds back into the image: only what leads there and back is seen.
bool sees(const CameraModel& lens, const CameraModel& pinhole, const Eigen::Vector2d& px) {
  constexpr double kSame = 1e-3;
  const Eigen::Vector2d raw_px = raw_of(lens, pinhole, px);
  if (!lens.contains_raw(raw_px)) return false;
  const auto back = lens.undistorted_from_raw(raw_px);
  return back && (lens.normalized_from_pixel(*back) - pinhole.normalized_from_pixel(px)).norm() < kSame;
}

// What is seen has no holes, so that its border tells.
bool is_full(const CameraModel& lens, const CameraModel& pinhole) {
  constexpr int kSteps = 32;
  const double right = pinhole.width_px - 1, bottom = pinhole.height_px - 1;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = right * i / kSteps, y = bottom * i / kSteps;
    for (const Eigen::Vector2d& px :
         {Eigen::Vector2d(x, 0), Eigen::Vector2d(x, bottom), Eigen::Vector2d(0, y), Eigen::Vector2d(right, y)})
      if (!sees(lens, pinhole, px)) return false;
  }
  return true;
}

// The tallest full image of that width; 0: there is none.
int half_height_px(const CameraModel& lens, int half_width_px, int most_px) {
  int full = 0, beyond = most_px + 1;
  while (beyond - full > 1) {
    const int middle = (full + beyond) / 2;
    (is_full(lens, pinhole(lens, half_width_px, middle)) ? full : beyond) = middle;
  }
  return full;
}

bool contains(const CameraModel& camera, const Eigen::Vector2d& px) {
  constexpr double kToEdge = 0.5;  // from the middle of a pixel
  return camera.contains_raw(px, -kToEdge);
}

}  // namespace

CameraModel pinhole_of(const CameraModel& lens) {
  constexpr int kWidths = 200;
  const double most = std::tan(M_PI / 3);
  const int most_x = static_cast<int>(most * lens.fx), most_y = static_cast<int>(most * lens.fy);
  int best_x = 0, best_y = 0;
  for (int i = 1; i <= kWidths; ++i) {
    const int x = most_x * i / kWidths;
    const int y = x > 0 ? half_height_px(lens, x, most_y) : 0;
    if (std::int64_t{x} * y > std::int64_t{best_x} * best_y) best_x = x, best_y = y;
  }
  if (best_x == 0) throw UserError("no part of the lens's image is that of a pinhole");
  return pinhole(lens, best_x, best_y);
}

Undistorter::Undistorter(const CameraModel& lens, const CameraModel& pinhole)
    : x_(pinhole.height_px, pinhole.width_px, CV_32F), y_(x_.size(), CV_32F) {
  for (int v = 0; v < x_.rows; ++v) {
    for (int u = 0; u < x_.cols; ++u) {
      const Eigen::Vector2d raw_px = raw_of(lens, pinhole, {u, v});
      x_.at<float>(v, u) = static_cast<float>(raw_px.x());
      y_.at<float>(v, u) = static_cast<float>(raw_px.y());
    }
  }
}

cv::Mat Undistorter::operator()(const cv::Mat& image) const {
  cv::Mat out;
  cv::remap(image, out, x_, y_, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return out;
}

void undistort_model(ColmapModel* model) {
  std::vector<CameraModel> lenses;
  for (auto& camera : model->cameras) {
    lenses.push_back(camera.model);
    camera.model = pinhole_of(camera.model);
  }
  for (auto& image : model->images) {
    const CameraModel &lens = lenses[image.camera], &pinhole = model->camera_of(image);
    std::vector<ColmapModel::Observation> seen;
    for (const auto& o : image.observations) {
      const auto undistorted_px = lens.undistorted_from_raw(o.px);
      if (!undistorted_px) continue;
      const Eigen::Vector2d px = pinhole.pixel_from_normalized(lens.normalized_from_pixel(*undistorted_px));
      if (contains(pinhole, px)) seen.push_back({px, o.point});
    }
    image.observations = std::move(seen);
  }
  link_points(model);
}

void write_undistorted_images(const std::vector<CameraModel>& lenses, double rate_hz,
                              const std::filesystem::path& folder, ColmapModel* model) {
  PointColors colors;
  for (std::size_t c = 0; c < model->cameras.size(); ++c) {
    const Undistorter undistort(lenses[c], model->cameras[c].model);
    see_images(*model, c, lenses[c], rate_hz, [&](const ColmapModel::Image& image, const cv::Mat& taken) {
      const cv::Mat seen = undistort(taken);
      write_image(folder / image.name, seen);
      colors.add(seen, image);
    });
  }
  colors.give(model);
}

}  // namespace coslam::exporting
