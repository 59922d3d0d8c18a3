// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <utility>
#include <vector>

#include "server/estimator/map/maps_pen.h"

namespace coslam {

// Verbs by which the memory of a long run is freed.
class PastPen : public MapsPen {
 protected:
  using MapsPen::MapsPen;

  // What was observed in an image that is not newer is kept no more; a key frame of which nothing is kept is none any
  // more.
  void forget_view(SetId set, CameraId camera);
  // Of the point's patches those go whose image has no frame any more, but for the first, which tells its grey.
  void forget_patches(const MapPoint& point);
  // Tracks forget where they were seen before that set.
  void forget_seen(SetId before);
  // A camera's frames up to that set are past: gives out all of them that are not yet, without what they held. In
  // memory stay those that `stays` says.
  std::vector<FramePose> take_frames(const MapCamera& camera, SetId before, const std::set<SetId>& stays);
  // The frame that memory still holds of the past goes too.
  void forget_frame(const MapCamera& camera, SetId set);
  // The oldest part of the paths of moving points leaves memory.
  std::vector<std::pair<PointId, MotionSample>> take_motions(SetId before);
};

}  // namespace coslam
