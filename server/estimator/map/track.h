// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <tuple>
#include <vector>

#include "common/base/fields.h"
#include "common/base/ids.h"
#include "common/model/track_frame.h"
#include "server/estimator/map/states.h"

namespace coslam {

struct TrackPoint {
  SetId set;
  Eigen::Vector2f undistorted_px;
};
auto fields(Like<TrackPoint> auto& p) {
  return std::tuple(kept("set", p.set), kept("undistorted_px", p.undistorted_px));
}

// Feature track of one camera, as the server knows it.
struct ServerTrack {
  TrackId id;
  PointId point;                   // 0 = unmapped
  std::vector<TrackPoint> seen;    // sorted by set, thinned when old
  std::optional<PatchGrey> patch;  // newest received
  SetId patch_set;
  std::uint32_t mapping_after = 0;      // set number before which mapping the track is not tried again
  int gate_failures = 0;                // successive failures
  std::uint32_t distrusted_before = 0;  // observations of earlier sets are not used (the track slid or was mismatched)
  TrackMotion motion = TrackMotion::kResting;
  std::optional<SetId> co_moving_since;  // set since which it went along with its camera, before it was found to move
  // Offset from the track to its point while that moves: two cameras find different corners of one small structure.
  Eigen::Vector2f offset_px = Eigen::Vector2f::Zero();

  bool bound() const { return point != PointId(); }
  bool moves() const { return motion == TrackMotion::kMoving; }
  // True when it may become part of the static map.
  bool free_and_resting() const { return !bound() && motion == TrackMotion::kResting; }
  // Returns the index in `seen`; empty when it was not seen at that set.
  std::optional<std::size_t> index_at(SetId set) const;
};
auto fields(Like<ServerTrack> auto& t) {
  return std::tuple(kept("id", t.id), kept("point", t.point), kept("seen", t.seen), kept("patch", t.patch),
                    kept("patch_set", t.patch_set), kept("mapping_after", t.mapping_after),
                    kept("gate_failures", t.gate_failures), kept("distrusted_before", t.distrusted_before),
                    kept("motion", t.motion), kept("offset_px", t.offset_px),
                    kept("co_moving_since", t.co_moving_since, 3));
}

// Observation of a track in one image.
struct HeldTrack {
  TrackId track;
  Eigen::Vector2f undistorted_px;
};
auto fields(Like<HeldTrack> auto& h) {
  return std::tuple(kept("track", h.track), kept("undistorted_px", h.undistorted_px));
}

// Observation of a corner in one image of one camera.
struct Sighting {
  CameraId camera;
  Eigen::Vector2f undistorted_px;
  Eigen::Vector2f step_px = Eigen::Vector2f::Zero();  // displacement since the previous image; 0 where the track began
};
auto fields(Like<Sighting> auto& s) {
  return std::tuple(kept("camera", s.camera), kept("undistorted_px", s.undistorted_px), kept("step_px", s.step_px));
}

}  // namespace coslam
