// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "common/geometry/steady_motion.h"
#include "server/estimator/covisibility/grouping.h"
#include "server/estimator/map/keys.h"
#include "server/estimator/pipeline/stage.h"
#include "server/estimator/pose/localise.h"

namespace coslam {

struct InterPoseConfig {
  bool enabled = true;
  int min_moving = 6;  // least moving points that two cameras of the group see
};

template <class V>
void describe(V& v, InterPoseConfig& c) {
  v.field("enabled", c.enabled, "poses from static and moving points of a whole group");
  v.field("min_moving", c.min_moving, {1, 1000}, "moving points that two cameras of the group see");
}

struct InterPoseReport {
  int calls = 0;
  int posed = 0;    // cameras that took its pose
  int rescued = 0;  // cameras among these that had no intra-camera pose

  void count(auto&& add) const {
    add("inter_pose_calls", calls);
    add("inter_posed", posed);
    add("rescued", rescued);
  }
};

// Estimates inter-camera poses (paper 4.2) for a group in which some camera sees more moving points than static ones,
// or static ones on a small part of its image only, or was lost in this set: all its cameras are localised together,
// from static and moving points, which have to agree with a pose as static ones have to otherwise; and from the motion
// model of such a camera. graph: of the set before. motions: of every camera, updated set by set.
InterPoseReport inter_pose(InterPoseEdit& edit, const FrameSet& set, const ViewGraph& graph,
                           const InterPoseConfig& config, const LocaliseConfig& localise,
                           std::map<CameraId, SteadyMotion>* motions);

class InterPose {
 public:
  static constexpr std::string_view kName = "inter_pose";
  using Config = InterPoseConfig;
  explicit InterPose(const InterPoseConfig& stage_config) : config(stage_config) {}
  InterPoseConfig config;

  InterPoseReport run(InterPoseEdit& edit, const FrameSet& set, Last<ViewGraph> graph, const LocaliseConfig& localise) {
    return inter_pose(edit, set, graph.of, config, localise, &motions_);
  }

 private:
  std::map<CameraId, SteadyMotion> motions_;
};

}  // namespace coslam
