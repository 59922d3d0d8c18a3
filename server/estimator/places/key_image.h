// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "common/base/fields.h"
#include "common/base/ids.h"
#include "common/geometry/pose_refinement.h"
#include "common/geometry/rigid3.h"

namespace coslam {

struct RecogniseConfig {
  int min_votes = 12;  // least features of an image that look like one of the key image
  int images = 4;      // best key images whose points are matched by appearance alone
  int min_first = 7;   // least of these matches that agree on a pose (chance: 4 or 5), which guides the search
  int around = 12;     // best key images whose points are then searched for near their projections
  int min_inliers = kLeastInliers;  // least inliers of the final pose
  double min_hull = 0.08;  // least share of the image that the matched points cover: a handful does not fix a pose
  int min_expected = 5;    // least points found where the pose predicts them: enough to believe the pose
  int min_beside = 8;      // least points found all a little beside that: enough to tell how far the map has drifted
};

// Key image: an image that the map remembers by its descriptors. The points behind its features are those with an
// observation of it.
struct KeyImage {
  SetId set;
  CameraId camera;
  std::vector<TrackId> tracks;  // sorted
  std::vector<std::uint8_t> descriptors;
};
auto fields(Like<KeyImage> auto& i) {
  return std::tuple(kept("set", i.set), kept("camera", i.camera), kept("tracks", i.tracks),
                    kept("descriptors", i.descriptors));
}

// Place of the map that a camera recognised.
struct PlaceMatch {
  MapId map;
  Rigid3 cam_from_world;  // pose in that map, by the place's points
  std::vector<std::pair<TrackId, PointId>> matches;
  CameraId key_camera;  // camera of the key image with most matches
  SetId key_set;
  double median_depth = 0;  // median depth of the matched points
  bool expected = false;    // near where the camera's pose in that map says
};

}  // namespace coslam
