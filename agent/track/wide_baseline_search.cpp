// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/wide_baseline_search.h"

#include <algorithm>
#include <utility>

#include "agent/track/wide_baseline.h"

namespace coslam {
namespace {

constexpr std::size_t kLeastMatches = 15;  // of features, to go by them; five by chance would be many
constexpr int kLongestRest_images = 30;

std::ptrdiff_t count_found(const Following& f) { return std::ranges::count(f.sightings, true, &TrackSighting::found); }

// So few that the image moved farther than windows can be followed.
bool few_found(const Following& f) {
  constexpr std::size_t kLeast = 30;  // tracks: fewer tell nothing of the image
  constexpr double kFew = 0.3;        // of them
  return f.sightings.size() >= kLeast &&
         static_cast<double>(count_found(f)) < kFew * static_cast<double>(f.sightings.size());
}

}  // namespace

void WideBaselineSearch::improve(Matcher& matcher, std::vector<Sought> sought, const Eigen::Vector2f& last_shift_px,
                                 Following* following) {
  if (!few_found(*following) || images_to_rest_-- > 0) return;
  MotionField motions = wide_baseline_motion(matcher.before().level(0).image(), matcher.newest().level(0).image());
  if (motions.size() < kLeastMatches) {
    images_to_rest_ = std::min(kLongestRest_images, ++searches_in_vain_);
    return;
  }
  searches_in_vain_ = 0;
  for (Sought& s : sought) s.motion_px = motions.near(s.from_px);
  Following farther = matcher.follow(sought, last_shift_px);
  if (count_found(farther) > count_found(*following)) *following = std::move(farther);
}

}  // namespace coslam
