// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/alternation.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

namespace coslam {
namespace {

constexpr std::size_t kShortWindow = 16;  // images

// Of so many settings each is seen four times.
std::size_t images_to_tell(std::size_t settings) { return std::max(kShortWindow, 4 * settings); }

}  // namespace

const Alternation::Changes& Alternation::Seen::changes(By feature) const {
  if (feature == By::kStep) return of_step;
  return feature == By::kExposure ? of_exposure : of_blocks;
}

bool Alternation::leaves_out(const cv::Mat& blocks, double step) {
  if (!window_.empty() && window_.back().blocks.size() != blocks.size()) *this = {};
  cv::Scalar mean, deviation;
  cv::meanStdDev(blocks, mean, deviation);
  Seen seen{blocks, step, mean[0], deviation[0], std::min(kMostBack, window_.size())};
  for (std::size_t back = 1; back <= seen.backs; ++back) {
    const Seen& before = window_[window_.size() - back];
    seen.of_blocks[back - 1] = cv::norm(blocks, before.blocks, cv::NORM_L1) / static_cast<double>(blocks.total());
    seen.of_step[back - 1] = std::abs(step - before.step);
    seen.of_exposure[back - 1] = std::abs(std::log((seen.mean + 1) / (before.mean + 1)));
  }
  if (settings_ > 1) {  // so many back there is one of each, even if one is missing
    const Changes& changes = seen.changes(feature_);
    const auto* const like = std::min_element(changes.begin(), changes.begin() + 2 * settings_ - 1);
    seen.used = window_[window_.size() - 1 - static_cast<std::size_t>(like - changes.begin())].used;
  }
  window_.push_back(std::move(seen));
  if (window_.size() > kWindow) window_.pop_front();
  note_settings();
  if (settings_ > 1 && none_used_of_late()) look_anew();
  return !window_.back().used;
}

// Of each setting there were two since.
bool Alternation::none_used_of_late() const {
  const auto late = window_.end() - std::min<std::ptrdiff_t>(std::ssize(window_), 2 * static_cast<int>(settings_));
  return std::none_of(late, window_.end(), [](const Seen& seen) { return seen.used; });
}

// Images whose settings do not come in their turn, as of a lamp that beats with the camera, were taken for like those
// that are left out, one after the other.
void Alternation::look_anew() {
  settings_ = 1;
  note_settings();
  if (settings_ == 1) choose(1);
}

// What else goes to and fro, as a camera that shakes, changes no exposure: only by that many settings are told.
void Alternation::note_settings() {
  constexpr std::size_t kFewSettings = 3;
  constexpr double kLeastChange = 10, kLeastStep = 0.15;  // grey values; of how much neighbouring pixels differ
  const double kOneStop = std::log(2);                    // at less, all of them can be followed
  if (window_.size() < kShortWindow) return;
  double step = 0;
  for (std::size_t i = window_.size() - kShortWindow; i < window_.size(); ++i) step += window_[i].step / kShortWindow;
  By feature = By::kBlocks;
  std::size_t settings = settings_by(feature, kFewSettings, kLeastChange);
  if (settings == 1) settings = settings_by(feature = By::kStep, kFewSettings, kLeastStep * step);
  if (settings == 1) settings = settings_by(feature = By::kExposure, kMostSettings, kOneStop);
  if (settings == settings_) return;
  feature_ = feature;
  choose(settings);
}

// Less than half the change means that there are several; they go on until it is nearly as much.
std::size_t Alternation::settings_by(By feature, std::size_t most_settings, double least_change) const {
  constexpr double kBegins = 0.5, kEnds = 0.8;  // of the change from one to the next
  if (settings_ > 1 && feature != feature_) return 1;
  std::size_t likest = 1;
  double least = 0;
  for (std::size_t settings = 2; settings <= most_settings && images_to_tell(settings) <= window_.size(); ++settings) {
    const double change = mean_change(feature, settings, window_.size() - images_to_tell(settings));
    if (likest > 1 && change >= least) continue;
    likest = settings;
    least = change;
  }
  const double next = mean_change(feature, 1, window_.size() - images_to_tell(likest));
  if (next < least_change || least > (settings_ > 1 ? kEnds : kBegins) * next) return 1;
  return settings_ > 1 ? settings_ : likest;
}

// Against so many before, of the images from the first of the window on, or of every so many of them.
double Alternation::mean_change(By feature, std::size_t back, std::size_t first, std::size_t every) const {
  double sum = 0, count = 0;
  for (std::size_t i = first; i < window_.size(); i += every) {
    if (window_[i].backs < back) continue;
    sum += window_[i].changes(feature)[back - 1];
    ++count;
  }
  return sum / count;
}

void Alternation::choose(std::size_t settings) {
  constexpr double kMore = 1.2, kLike = 0.25;  // of contrasts; of the change from one to the next
  settings_ = settings;
  const std::size_t first = window_.size() - images_to_tell(settings) / settings * settings;
  std::vector<Seen> means(settings);
  for (std::size_t i = first; i < window_.size(); ++i) {
    Seen& mean = means[i % settings];
    mean.step += window_[i].step;
    mean.mean += window_[i].mean;
    mean.contrast += window_[i].contrast;
  }
  const double most = std::ranges::max_element(means, {}, &Seen::contrast)->contrast;
  const auto badness = [&](const Seen& s) {
    if (feature_ == By::kStep) return s.step;
    return s.contrast * kMore < most ? HUGE_VAL : s.mean;
  };
  const auto best = static_cast<std::size_t>(std::ranges::min_element(means, {}, badness) - means.begin());
  // Of dots in every third image the other two are alike.
  const auto is_like_best = [&](std::size_t setting) {
    if (setting == best) return true;
    const std::size_t back = (setting + settings - best) % settings;
    return mean_change(feature_, back, setting, settings) < kLike * mean_change(feature_, 1, first);
  };
  for (std::size_t i = 0; i < window_.size(); ++i) window_[i].used = is_like_best(i % settings);
}

}  // namespace coslam
