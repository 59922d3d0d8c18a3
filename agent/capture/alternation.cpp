// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/alternation.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

namespace coslam {

bool Alternation::leaves_out(const cv::Mat& blocks, double step) {
  if (!window_.empty() && window_.back().blocks.size() != blocks.size()) *this = {};
  cv::Scalar mean, deviation;
  cv::meanStdDev(blocks, mean, deviation);
  Seen seen{blocks, step, mean[0], deviation[0]};
  for (std::size_t back = 1; back <= std::min(kMostBack, window_.size()); ++back) {
    const Seen& before = window_[window_.size() - back];
    seen.of_blocks[back - 1] = cv::norm(blocks, before.blocks, cv::NORM_L1) / static_cast<double>(blocks.total());
    seen.of_step[back - 1] = std::abs(step - before.step);
  }
  if (settings_ > 1) {  // so many back there is one of each, even if one is missing
    const Changes& changes = by_step_ ? seen.of_step : seen.of_blocks;
    const auto* const like = std::min_element(changes.begin(), changes.begin() + 2 * settings_ - 1);
    seen.used = window_[window_.size() - 1 - static_cast<std::size_t>(like - changes.begin())].used;
  }
  window_.push_back(std::move(seen));
  if (window_.size() > kWindow) window_.pop_front();
  note_settings();
  return !window_.back().used;
}

void Alternation::note_settings() {
  constexpr double kLeastChange = 10, kLeastStep = 0.15;  // grey values; of how much neighbouring pixels differ
  if (window_.size() < kWindow) return;
  double step = 0;
  for (const Seen& s : window_) step += s.step / kWindow;
  std::size_t settings = settings_by(&Seen::of_blocks, kLeastChange);
  const bool by_step = settings == 1;
  if (by_step) settings = settings_by(&Seen::of_step, kLeastStep * step);
  if (settings == settings_) return;
  by_step_ = by_step;
  choose(settings);
}

// Less than half the change means that there are several; they go on until it is nearly as much.
std::size_t Alternation::settings_by(Changes Seen::*changes, double least_change) const {
  constexpr double kBegins = 0.5, kEnds = 0.8;  // of the change from one to the next
  Changes sums{};
  for (const Seen& s : window_) {
    for (std::size_t i = 0; i < kMostSettings; ++i) sums[i] += (s.*changes)[i];
  }
  const auto* const least = std::min_element(sums.begin() + 1, sums.begin() + kMostSettings);
  if (sums[0] < least_change * kWindow || *least > (settings_ > 1 ? kEnds : kBegins) * sums[0]) return 1;
  return settings_ > 1 ? settings_ : static_cast<std::size_t>(least - sums.begin()) + 1;
}

void Alternation::choose(std::size_t settings) {
  constexpr double kMore = 1.2;  // contrast
  settings_ = settings;
  struct Setting {
    double mean = 0, contrast = 0;
  };
  std::array<Setting, kMostSettings> sums{};
  for (std::size_t i = 0; i < window_.size(); ++i) {
    sums[i % settings].mean += window_[i].mean;
    sums[i % settings].contrast += window_[i].contrast;
  }
  const auto better = [&](const Setting& a, const Setting& b) {
    if (a.contrast > kMore * b.contrast || b.contrast > kMore * a.contrast) return a.contrast > b.contrast;
    return a.mean < b.mean;
  };
  std::size_t best = 0;
  for (std::size_t i = 1; i < settings; ++i) best = better(sums[i], sums[best]) ? i : best;
  for (std::size_t i = 0; i < window_.size(); ++i) window_[i].used = i % settings == best;
}

}  // namespace coslam
