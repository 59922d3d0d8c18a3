// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map/edit.h"
#include "server/stages/group.h"
#include "server/stages/localise.h"

namespace coslam {

struct InterPoseConfig {
  bool enabled = true;
  double hull_area_min = 0.20;  // of the image, covered by a camera's static points
  int max_iterations = 15;
  int min_inliers = 12;  // static and moving together, of each camera
  int min_moving = 6;    // moving points that two cameras of the group see
};

struct InterPoseReport {
  int calls = 0;
  int posed = 0;    // cameras that took its pose
  int rescued = 0;  // of those, without a pose of their own
};

// Inter-camera pose (paper 4.2), for a group of which some camera sees more moving points than static ones, or static
// ones on a small part of its image only, or lost its way in this set: all its cameras are localised together, from
// static and moving points. graph: of the set before.
InterPoseReport inter_pose(MapEdit& edit, const FrameSet& set, const ViewGraph& graph, const InterPoseConfig& config);

}  // namespace coslam
