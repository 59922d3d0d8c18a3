// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/workers.h"
#include "common/geometry/pose_refinement.h"
#include "server/estimator/map/keys.h"

namespace coslam {

struct LocaliseConfig {
  int min_inliers = kLeastInliers;
  double lost_after_s = 0.5;  // time without a pose after which a camera leaves its map
};

template <class V>
void describe(V& v, LocaliseConfig& c) {
  v.field("min_inliers", c.min_inliers, {6, 1000}, "static points that agree with a pose; fewer: lost");
  v.field("lost_after_s", c.lost_after_s, {0.01, 1000}, "without a pose for so long, a camera leaves its map");
}

struct LocaliseReport {
  int tracked = 0;
  int on_own_word = 0;  // cameras that keep the agent's pose, which rests on points that the map does not have
  int lost = 0;

  void count(auto&& add) const {
    add("tracked", tracked);
    add("on_own_word", on_own_word);
    add("lost", lost);
  }
};

// Estimates the intra-camera pose (paper 4.1) of every camera of the set that belongs to a map: the agent's pose is the
// start, and it is refined on the server's newest points, so that map and pose always fit, however late the agent's
// local map was.
LocaliseReport localise(LocaliseEdit& edit, const FrameSet& set, const LocaliseConfig& config,
                        Workers& workers = Workers::alone());

// Initial estimate of a camera's pose at the newest set: the agent's pose if it belongs to this map's present epoch,
// else the motion model's prediction.
Rigid3 start_pose(const Map& map, const MapCamera& camera, const TrackFrame& frame);

// Estimates the pose of one camera at an earlier set from the points bound to its live tracks; false when there is
// none.
bool localise_past(FramePoseEdit& edit, const MapCamera& camera, SetId set, const Rigid3& start,
                   const LocaliseConfig& config);

// Estimates poses of one camera set by set back from a known pose, until a set has a pose or none is found.
void localise_backwards(FramePoseEdit& edit, const MapCamera& camera, SetId from, const LocaliseConfig& config);

struct Localise {
  static constexpr std::string_view kName = "localise";
  using Config = LocaliseConfig;
  Config config;
  LocaliseReport run(LocaliseEdit& edit, const FrameSet& set, Workers& workers) const {
    return localise(edit, set, config, workers);
  }
};

}  // namespace coslam
