// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/map/keys.h"
#include "server/estimator/pipeline/stage.h"
#include "server/estimator/pose/localise.h"

namespace coslam {

struct FindAgainConfig {
  double search_rad = 0.03;  // so far from where a point should appear it is looked for
  double memory_s = 60;      // points that were seen so lately
};

template <class V>
void describe(V& v, FindAgainConfig& c) {
  v.field("search_rad", c.search_rad, {0.001, 0.5}, "so far from where a point should appear it is looked for");
  v.field("memory_s", c.memory_s, {0.1, 10000}, "points that were seen so lately are looked for");
}

struct FindAgainReport {
  int cameras = 0, points = 0;

  void count(auto&& add) const {
    add("found_again_cameras", cameras);
    add("found_again", points);
  }
};

// A camera that lost sight of nearly all its points, by a turn say, and comes back to them with a pose that drifted
// meanwhile finds none within the gates. Looks for proven points around where they should appear, by their patches;
// where enough of what is found agrees on one pose, the camera takes it, and its tracks those points.
FindAgainReport find_again(WideSearchEdit& edit, const FrameSet& set, const FindAgainConfig& config, int least);

struct FindAgain {
  static constexpr std::string_view kName = "find_again";
  using Config = FindAgainConfig;
  Config config;
  bool due(const Map& map) const { return map.every(map.config().match_period_s); }
  FindAgainReport run(WideSearchEdit& edit, const FrameSet& set, const LocaliseConfig& localise) const {
    return find_again(edit, set, config, localise.min_inliers);
  }
};

}  // namespace coslam
