// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <utility>
#include <vector>

#include "server/estimator/map/maps_pen.h"

namespace coslam {

// Verbs that free the memory of a long run.
class PastPen : public MapsPen {
 protected:
  using MapsPen::MapsPen;

  // Drops the observations of one earlier image; a key frame of which nothing is kept is no key frame any more.
  void forget_view(SetId set, CameraId camera);
  // Drops those of the point's patches whose image has no frame any more, except the first, which tells its grey value.
  void forget_patches(const MapPoint& point);
  // Drops the observations of all tracks before that set.
  void forget_seen(SetId before);
  // Archives a camera's frames before that set: returns all that were not returned earlier, without what they held.
  // Only the frames in `stays` remain in memory.
  std::vector<FramePose> take_frames(const MapCamera& camera, SetId before, const std::set<SetId>& stays);
  // Drops a frame that was archived but remained in memory.
  void forget_frame(const MapCamera& camera, SetId set);
  // Takes the samples before that set out of the paths of moving points.
  std::vector<std::pair<PointId, MotionSample>> take_motions(SetId before);
};

}  // namespace coslam
