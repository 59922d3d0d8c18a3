// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/workers.h"
#include "server/estimator/map/keys.h"
#include "server/estimator/motion/evidence.h"
#include "server/estimator/motion/follow.h"

namespace coslam {

struct ClassifyConfig {
  bool enabled = true;
  EvidenceConfig evidence;
  FollowConfig follow;
};

template <class V>
void describe(V& v, ClassifyConfig& c) {
  v.field("enabled", c.enabled, "tell moving points from static ones");
  describe(v, c.evidence);
}

struct ClassifyReport {
  int uncertain = 0, dynamic = 0, removed = 0;  // changes of state in this set
  int stopped = 0;                              // dynamic to static
  int slid = 0;                                 // tracks that left their static point
  int rebound = 0;                              // further tracks of moving points
  int moving_tracks = 0;                        // unmapped tracks that move in this set

  void count(auto&& add) const {
    add("became_uncertain", uncertain);
    add("became_dynamic", dynamic);
    add("became_static", stopped);
    add("found_false", removed);
    add("unbound", slid);
    add("rebound", rebound);
    add("moving_track_sets", moving_tracks);
  }
};

// Updates the state of points and tracks every frame set (paper 5.4); evidence.h judges.
//   static: a track outside the gate `failures` sets in succession. When several cameras see the point elsewhere and
//   this instant's observations agree on one position, it moves; when they do not, it is false and removed. When it is
//   one track alone, that slid and leaves the point.
//   moving: its position is that of this instant's observations (follow.h); static again when its tracks did not move
//   against it in the last `still_s`. Poses rest on it only when it has proved itself again. A camera that alone still
//   sees it gives its track back when that stands still.
// A track without a point is judged by one camera's own motion: moving or doubtful ones do not become static points.
ClassifyReport classify(ClassifyEdit& edit, const FrameSet& set, const ClassifyConfig& config,
                        Workers& workers = Workers::alone());

struct Classify {
  static constexpr std::string_view kName = "classify";
  using Config = ClassifyConfig;
  Config config;
  ClassifyReport run(ClassifyEdit& edit, const FrameSet& set, Workers& workers) const {
    return classify(edit, set, config, workers);
  }
};

}  // namespace coslam
