// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/depth_ratio.h"

#include <algorithm>
#include <cmath>

namespace coslam {

std::optional<double> depth_ratio(std::vector<double> log_ratios) {
  constexpr double kMostSpread = 0.3;  // between the quartiles
  if (log_ratios.size() < kLeastPairs) return std::nullopt;
  std::ranges::sort(log_ratios);
  const std::size_t n = log_ratios.size();
  const double spread = log_ratios[n * 3 / 4] - log_ratios[n / 4];
  if (spread > kMostSpread) return std::nullopt;
  return std::exp(log_ratios[n / 2]);
}

}  // namespace coslam
