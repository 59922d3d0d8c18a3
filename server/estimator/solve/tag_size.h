// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "common/base/fields.h"
#include "common/base/ids.h"
#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"

namespace coslam {

// One image of a printed square tag.
struct TagView {
  CameraId camera;
  const CameraModel* model = nullptr;
  Rigid3 cam_from_world;
  std::array<Eigen::Vector2d, 4> undistorted_px;  // corners, clockwise as printed
  double gate_px = 1;                             // RMS error over the corners above which this view is wrong
};

enum class TagStatus : std::uint8_t {
  kOk,
  kUndetermined,  // too few views, or all from one direction
  kNotOnePlace,   // the views do not agree: the tag moved, or is printed twice
  kNotSquare,     // the corners are in one place, but form no square within the uncertainty
};

struct TagSize {
  TagStatus status = TagStatus::kUndetermined;
  double side = 0;        // length in units of the poses
  double sigma = 0;       // standard deviation of the side
  int views = 0;          // number of views that agree
  double error_px = 0;    // RMS of one coordinate over the views that agree
  double chi_square = 0;  // misfit of the square through the corners, 5 degrees of freedom
};
auto fields(Like<TagSize> auto& t) {
  return std::tuple(kept("status", t.status), kept("side", t.side), kept("sigma", t.sigma), kept("views", t.views),
                    kept("error_px", t.error_px), kept("chi_square", t.chi_square));
}

struct TagSizeConfig {
  double sigma_px = 0.3;  // least standard deviation of a corner, the pose's error included; the residuals may raise it
  double most_wrong = 0.2;  // largest share of wrong views
  double flatness = 0.003;  // deviation of a corner from the ideal square, as a share of the side: paper bends
};

// Measures the side of a tag from views whose poses are known. Each corner is triangulated from all views that agree;
// then a square with free pose and side is fitted to the corners, weighted with their covariances (4), by Gauss-Newton.
// Views of one camera repeat the errors of its poses: however many, they count for two, as in Map::covariance_of().
TagSize measure_tag(std::span<const TagView> views, const TagSizeConfig& config);

}  // namespace coslam
