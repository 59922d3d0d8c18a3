// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "server/places/close_loop.h"

// The scale between two maps, or two parts of one, is told by depths of the same places in both.
namespace coslam {

// Lengths there over lengths here.
struct DepthRatio {
  double scale = 1;
  double log_sigma = 0;  // of its logarithm
};

inline constexpr std::size_t kLeastDepthRatios = 10;

// The median; nothing when they are too few or do not agree.
std::optional<DepthRatio> depth_ratio(std::vector<double> log_ratios);

// The scale of a loop as it is likely, from what depths say: a map whose scale drifts by so much on its way comes home
// as far from where it began as half of that makes of the way's width, so where little is missing to close the loop,
// little scale is.
double likely_scale(const Map& map, const LoopConstraint& loop, double log_sigma);

}  // namespace coslam
