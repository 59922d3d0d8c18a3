// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/base/metrics.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>

namespace coslam {
namespace {
constexpr double kFirstMs = 1e-3;
const double kLogRatio = std::log(1.04);
}  // namespace

void DurationHistogram::add_ms(double ms) {
  const double bin = std::log(std::max(ms, kFirstMs) / kFirstMs) / kLogRatio;
  ++bins_[std::min(static_cast<std::size_t>(bin), kBins - 1)];
  ++count_;
  sum_ms_ += ms;
  max_ms_ = std::max(max_ms_, ms);
}

double DurationHistogram::percentile_ms(double percent) const {
  if (count_ == 0) return 0.0;
  const double wanted = percent / 100.0 * static_cast<double>(count_);
  double seen = 0.0;
  for (std::size_t i = 0; i + 1 < kBins; ++i) {
    seen += bins_[i];
    if (seen >= wanted && bins_[i] > 0) {
      return std::min(max_ms_, kFirstMs * std::exp((static_cast<double>(i) + 0.5) * kLogRatio));
    }
  }
  return max_ms_;
}

double peak_memory_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace coslam
