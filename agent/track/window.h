// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "agent/track/kernels.h"
#include "agent/track/pyramid.h"

namespace coslam {

// Distance by which a window's centre may lie beyond the level: half a window, a pixel for the derivative, one for the
// interpolation, and what kTemplateCols reads beyond stay in the margin.
constexpr float kWindowReach_px = PyramidLevel::kMargin - kWindowHalf_px - 2 - (kTemplateCols - kTemplateRows);

// A window of one image, to be found in another, with what Gauss-Newton needs of it. Another window is explained as
// gain * template(moved) + offset: taking means out eliminates the offset, the third row the gain.
struct WindowTemplate {  // NOLINT(cppcoreguidelines-pro-type-member-init): the samples are written at once
  Samples grey, dx, dy;
  int total_grey = 0, total_dx = 0, total_dy = 0;
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();  // inverse of the products of (dx, dy, grey), means taken out
  double squares = 0;                                 // sum of squares of grey, mean taken out
  // Smaller eigenvalue of the structure tensor, gain and offset eliminated: (grey levels / pixel)^2, summed.
  double min_eigenvalue = 0;
};

// Whether the window centred there, with a pixel around it, lies in the level and its margin.
bool window_readable(const PyramidLevel& level, const Eigen::Vector2f& centre_px);

// The centres below must be readable.
void cut_template(const PyramidLevel& level, const Eigen::Vector2f& centre_px, WindowTemplate& window);

// Estimates how far centre_px lies from where the template is found, to first order, and with which gain.
struct WindowStep {
  Eigen::Vector2f offset_px = Eigen::Vector2f::Zero();
  float gain = 0.0f;  // offset_px means nothing unless this is positive
};
WindowStep window_step(const PyramidLevel& level, const Eigen::Vector2f& centre_px, const WindowTemplate& window);

// Zero-mean normalised cross-correlation of the window at centre_px with the template, -1 to 1; 0 where one is flat.
float window_zncc(const PyramidLevel& level, const Eigen::Vector2f& centre_px, const WindowTemplate& window);

}  // namespace coslam
