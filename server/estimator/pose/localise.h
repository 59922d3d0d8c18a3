// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/workers.h"
#include "server/estimator/map/keys.h"

namespace coslam {

struct LocaliseConfig {
  int min_inliers = 12;
  double lost_after_s = 0.5;  // without a pose for so long: the camera leaves its map
};

template <class V>
void describe(V& v, LocaliseConfig& c) {
  v.field("min_inliers", c.min_inliers, {6, 1000}, "static points that agree with a pose; fewer: lost");
  v.field("lost_after_s", c.lost_after_s, {0.01, 1000}, "without a pose for so long, a camera leaves its map");
}

struct LocaliseReport {
  int tracked = 0;
  int on_own_word = 0;  // where its agent says that it is, with points that the map has not
  int lost = 0;

  void count(auto&& add) const {
    add("tracked", tracked);
    add("on_own_word", on_own_word);
    add("lost", lost);
  }
};

// Intra-camera pose (paper 4.1) of every camera of the set that belongs to a map: the agent's own pose is the start,
// and it is refined on the server's newest points, so that map and pose always fit, however late the agent's local map
// was.
LocaliseReport localise(LocaliseEdit& edit, const FrameSet& set, const LocaliseConfig& config,
                        Workers& workers = Workers::alone());

// Where to start looking for a camera's pose at the newest set: the agent's own when it speaks of this map as it is
// now, else the motion so far.
Rigid3 start_pose(const Map& map, const MapCamera& camera, const TrackFrame& frame);

// Pose of one camera at an earlier set from the points bound to its live tracks; false when there is none.
bool localise_past(FramePoseEdit& edit, const MapCamera& camera, SetId set, const Rigid3& start,
                   const LocaliseConfig& config);

// The same back from a known pose, until there is one or none is found.
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
