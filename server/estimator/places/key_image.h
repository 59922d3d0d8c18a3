// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "common/base/fields.h"
#include "common/base/ids.h"
#include "common/geometry/rigid3.h"

namespace coslam {

struct RecogniseConfig {
  int min_votes = 12;      // features that look like one of the key image
  int images = 4;          // best key images whose points are matched by their looks alone
  int min_first = 7;       // of these, that agree on a pose (chance makes 4 or 5): others are looked for by that
  int around = 12;         // best key images whose points are looked for then
  int min_inliers = 12;    // of the pose in the end
  double min_hull = 0.08;  // of the image, by the matched points: a handful on one object does not fix a pose
  int min_expected = 5;    // points found where the pose says they are: enough to believe it
  int min_beside = 8;      // found all a little beside that: enough to tell how far the map has drifted
};

// An image that the map remembers by its looks. The points behind its features are those with an observation of it.
struct KeyImage {
  SetId set;
  CameraId camera;
  std::vector<TrackId> tracks;  // ascending
  std::vector<std::uint8_t> descriptors;
};
auto fields(Like<KeyImage> auto& i) {
  return std::tuple(kept("set", i.set), kept("camera", i.camera), kept("tracks", i.tracks),
                    kept("descriptors", i.descriptors));
}

// A camera saw a place that the map knows.
struct PlaceMatch {
  MapId map;
  Rigid3 cam_from_world;  // in that map, by the place's points
  std::vector<std::pair<TrackId, PointId>> matches;
  CameraId key_camera;  // of the key image with most of them
  SetId key_set;
  double median_depth = 0;  // of the matched points
  bool expected = false;    // not far from where the camera's pose in that map says
};

}  // namespace coslam
