// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

// The scale between two maps, or two parts of one, is told by depths of the same places in both.
namespace coslam {

inline constexpr std::size_t kLeastDepthRatios = 10;

// Lengths there over lengths here: the median; nothing when they are too few or do not agree.
std::optional<double> depth_ratio(std::vector<double> log_ratios);

}  // namespace coslam
