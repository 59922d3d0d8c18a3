// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "agent/track/pyramid.h"

// The inner loops of the tracker: sums over a 16 x 16 window at a sub-pixel place. All in 16-bit integers, which every
// processor's vector unit does well without special builds, and which give the same bits on all of them.
namespace coslam {

constexpr int kWindowSide = 16;
constexpr int kWindowArea = kWindowSide * kWindowSide;
// The window's pixels lie at centre - 7.5 ... centre + 7.5 in x and y.
constexpr float kWindowHalf_px = 0.5f * (kWindowSide - 1);

// A window of one image, to be found in another, with what Gauss-Newton needs of it. `products` are the sums of
// products of (dx, dy, grey) with each other, means removed: to eliminate grey and the constant is to allow a gain and
// an offset.
struct WindowTemplate {
  alignas(64) std::array<std::int16_t, kWindowArea> grey;
  alignas(64) std::array<std::int16_t, kWindowArea> dx;
  alignas(64) std::array<std::int16_t, kWindowArea> dy;
  std::array<int, 3> sums{};  // of dx, dy, grey
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
  double min_eigenvalue = 0;  // of the structure tensor, gain and offset eliminated: (grey / pixel)^2, summed

  void prepare();  // computes everything below `dy` from the three arrays
};

// Whether the window centred there, with a pixel around it, lies in the level and its margin.
bool window_readable(const PyramidLevel& level, const Eigen::Vector2f& centre_px);

// The centres below must be readable.
void cut_template(const PyramidLevel& level, const Eigen::Vector2f& centre_px, WindowTemplate& window);

// The window at centre_px explained as gain * template(moved by d) + offset, linearised: d, and the gain.
struct WindowStep {
  Eigen::Vector2f d_px;  // from where the template's content is to centre_px; subtract it
  float gain = 0.0f;
};
WindowStep window_step(const PyramidLevel& level, const Eigen::Vector2f& centre_px, const WindowTemplate& window);

// Zero-mean normalised cross-correlation of the window at centre_px with the template, -1 to 1; 0 where one is flat.
float window_zncc(const PyramidLevel& level, const Eigen::Vector2f& centre_px, const WindowTemplate& window);

}  // namespace coslam
