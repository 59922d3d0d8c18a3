// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/map/keys.h"
#include "server/estimator/pipeline/stage.h"
#include "server/estimator/pose/localise.h"

namespace coslam {

struct WideSearchConfig {
  double search_rad = 0.03;  // angle around where a point should appear within which it is searched for
  double memory_s = 60;      // age up to which points that were seen are searched for
};

template <class V>
void describe(V& v, WideSearchConfig& c) {
  v.field("search_rad", c.search_rad, {0.001, 0.5}, "so far from where a point should appear it is looked for");
  v.field("memory_s", c.memory_s, {0.1, 10000}, "points that were seen so lately are looked for");
}

struct WideSearchReport {
  int cameras = 0, points = 0;

  void count(auto&& add) const {
    add("found_again_cameras", cameras);
    add("found_again", points);
  }
};

// Recovers a camera that lost sight of nearly all its points, by a turn for example, and returns to them with a drifted
// pose, so that none are within the gates. Searches for proven points around where they should appear, by their
// patches; where enough of the matches agree on one pose, the camera takes it, and its tracks are bound to those
// points.
WideSearchReport wide_search(WideSearchEdit& edit, const FrameSet& set, const WideSearchConfig& config, int least);

struct WideSearch {
  static constexpr std::string_view kName = "wide_search";
  using Config = WideSearchConfig;
  Config config;
  bool due(const Map& map) const { return map.every(map.config().match_period_s); }
  WideSearchReport run(WideSearchEdit& edit, const FrameSet& set, const LocaliseConfig& localise) const {
    return wide_search(edit, set, config, localise.min_inliers);
  }
};

}  // namespace coslam
