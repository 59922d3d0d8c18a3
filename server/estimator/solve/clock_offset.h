// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace coslam {

// What a moving point tells of two cameras' clocks at one instant t: the epipolar residual of what both would have seen
// at t by their own stamps, and how fast it changes when the first or second image is dated later. With true capture
// times = stamps + offset, the residual of one instant is residual_px - rates . offsets.
struct ClockObservation {
  double residual_px = 0;
  Eigen::Vector2d rates_px_s = Eigen::Vector2d::Zero();  // d residual / d stamp of the first and second
  // The same from other pixels: with independent noise.
  Eigen::Vector2d other_rates_px_s = Eigen::Vector2d::Zero();
  double weight = 1;  // less for one of many that share the error of their cameras' poses
};

// One pair of tracks over a short time. Their corners are not quite the same place, which shifts all its residuals
// alike.
struct ClockStretch {
  int first = 0, second = 0;  // camera indices
  double sigma_px = 0.35;     // of a residual
  std::vector<ClockObservation> seen;
};

struct ClockOffset {
  double offset_s = 0;  // the camera's images were taken so much later than dated, against the reference's
  double sigma_s = 0;   // 0: it is the reference
};

// Offsets o, and shifts b of the stretches, of
//   argmin sum_stretches [ (b / sigma_b)^2 + sum_i weight_i rho((r_i - J_i o - b) / sigma) ] + (o / prior_s)^2,
// rho Tukey's, J the rates. The normal equations are those with the other rates as instruments: the noise of rates that
// stand on both sides would shorten the offsets. The first camera of those that the stretches connect is the reference:
// its offset is 0. Still points have zero rates: they say nothing.
std::vector<ClockOffset> solve_clock_offsets(int cameras, std::span<const ClockStretch> stretches, double prior_s);

}  // namespace coslam
