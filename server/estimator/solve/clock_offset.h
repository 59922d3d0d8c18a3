// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace coslam {

// Observation of two cameras' clocks by a moving point at one instant t: the epipolar residual of what both would have
// seen at t by their own stamps, and how fast it changes when the first or second image is dated later. With true
// capture times = stamps + offset, the residual of one instant is residual_px - rates . offsets.
struct ClockObservation {
  double residual_px = 0;
  Eigen::Vector2d rates_px_s = Eigen::Vector2d::Zero();  // d residual / d stamp of the first and second
  // Rates from other pixels, so that their noise is independent of that in rates_px_s.
  Eigen::Vector2d other_rates_px_s = Eigen::Vector2d::Zero();
  double weight = 1;  // less for one of many that share the error of their cameras' poses
};

// Pair of tracks over a short time. Their corners are not quite the same place, which shifts all residuals alike.
struct ClockStretch {
  int first = 0, second = 0;  // camera indices
  double sigma_px = 1;        // standard deviation of a residual
  std::vector<ClockObservation> seen;
};

struct ClockOffset {
  double offset_s = 0;  // images of this camera were taken later than dated by this much, relative to the reference
  double sigma_s = 0;   // 0: it is the reference
};

// Solves for the offsets o, and shifts b of the stretches, of
//   argmin sum_stretches [ (b / sigma_b)^2 + sum_i weight_i rho((r_i - J_i o - b) / sigma) ] + (o / prior_s)^2,
// rho Tukey's, J the rates. The normal equations are those with the other rates as instruments: the noise of rates that
// stand on both sides would shorten the offsets. The first camera of those that the stretches connect is the reference:
// its offset is 0. Still points have zero rates and carry no information.
std::vector<ClockOffset> solve_clock_offsets(int cameras, std::span<const ClockStretch> stretches, double prior_s);

}  // namespace coslam
