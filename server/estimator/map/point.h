// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include "common/base/fields.h"
#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/model/map_patch.h"
#include "common/model/track_frame.h"
#include "server/estimator/map/states.h"
#include "server/estimator/map/track.h"

namespace coslam {

// Most patches that are kept of a point.
inline constexpr std::size_t kPatchesOfPoint = 6;

struct KeyObservation {
  SetId set;
  CameraId camera;
  TrackId track;
  Eigen::Vector2f undistorted_px;
};
auto fields(Like<KeyObservation> auto& o) {
  return std::tuple(kept("set", o.set), kept("camera", o.camera), kept("track", o.track),
                    kept("undistorted_px", o.undistorted_px));
}

struct PointPatch {  // NOLINT(cppcoreguidelines-pro-type-member-init): never without its pixels
  CameraId camera;
  SetId set;  // set of the image it was cut from
  PatchGrey pixels;
  Eigen::Vector2f offset_px = Eigen::Vector2f::Zero();  // offset from the patch's centre to the point
};
auto fields(Like<PointPatch> auto& p) {
  return std::tuple(kept("camera", p.camera), kept("set", p.set), kept("pixels", p.pixels),
                    kept("offset_px", p.offset_px));
}

struct BoundTrack {
  CameraId camera;
  TrackId track;
  friend bool operator==(const BoundTrack&, const BoundTrack&) = default;
};
auto fields(Like<BoundTrack> auto& b) { return std::tuple(kept("camera", b.camera), kept("track", b.track)); }

struct MapPoint {
  PointId id;
  MapId map;
  PointPhase phase = PointPhase::kStatic;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  SetId created;
  SetId last_seen;
  TimeNs first_ns = 0;
  TimeNs last_ns = 0;
  std::vector<KeyObservation> key_observations;  // observations at key frames and key images, sorted by (set, camera)
  std::vector<BoundTrack> bound;                 // live tracks
  std::vector<PointPatch> patches;               // few, from different directions
  std::uint32_t views = 0;                       // observations within the gate, over all frames
  std::vector<Eigen::Vector3d> updated_from;  // ray at the last Kalman update by each camera, or 0; as long as needed

  bool moves() const { return phase == PointPhase::kMoving; }
  bool rests() const { return phase != PointPhase::kMoving; }  // static, or on trial for it
  bool proven() const { return phase == PointPhase::kStatic; }
};
auto fields(Like<MapPoint> auto& p) {
  return std::tuple(kept("id", p.id), kept("map", p.map), kept("phase", p.phase), kept("position", p.position),
                    kept("covariance", p.covariance), kept("created", p.created), kept("last_seen", p.last_seen),
                    instant("first_ns", p.first_ns), instant("last_ns", p.last_ns),
                    kept("key_observations", p.key_observations), kept("bound", p.bound), kept("patches", p.patches),
                    kept("views", p.views), kept("updated_from", p.updated_from));
}

// State of a point as agents and files are told.
PointState told_state(PointPhase phase);

// Observations of a moving point at one set; its position at the instant t_ns follows from the poses and the clocks,
// whenever these are corrected.
struct MotionSample {
  SetId set;
  TimeNs t_ns = 0;
  std::vector<Sighting> seen;
};
auto fields(Like<MotionSample> auto& s) {
  return std::tuple(kept("set", s.set), instant("t_ns", s.t_ns), kept("seen", s.seen));
}

// True when a live track of the camera shows the point.
bool seen_by(const MapPoint& point, CameraId camera);
// True when live tracks of one camera show both points, so that they are two things.
bool seen_at_once(const MapPoint& p, const MapPoint& q);

}  // namespace coslam
