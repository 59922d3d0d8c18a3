// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

// Scale between two maps, or two parts of one, from depths of the same places in both.
namespace coslam {

// Least number of pairs of one point in two maps that tell how the maps lie to each other.
inline constexpr std::size_t kLeastPairs = 10;

// Returns the median ratio of lengths there to lengths here; empty when the ratios are too few or do not agree.
std::optional<double> depth_ratio(std::vector<double> log_ratios);

}  // namespace coslam
