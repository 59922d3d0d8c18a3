// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/map/pen.h"

namespace coslam {

// Verbs on tracks: which point each shows, and what contradicts that.
class TrackPen : public MapPen {
 protected:
  using MapPen::MapPen;

  // Binds a track to a point, with its observations at key frames so far and its patch.
  void bind(const MapPoint& to, CameraId camera, const ServerTrack& server_track, Why why, Figures figures = {});
  // Binds a track to a moving point, which lies offset_px from the track in the image. The track's views so far say
  // nothing about where the point is now.
  void bind_moving(const MapPoint& point, CameraId camera, const ServerTrack& track, const Eigen::Vector2f& offset_px,
                   Why why, Figures figures = {});
  void unbind(CameraId camera, const ServerTrack& server_track, Why why, Figures figures = {});
  // Adds the track's image patch to the point's.
  void give_patch(const MapPoint& point, CameraId camera, const ServerTrack& track);
  // Excludes what the track saw before this set from further use.
  void distrust_before(const ServerTrack& track, SetId set) { mutable_track(track).distrusted_before = set.value; }
  // Counts a gate failure and returns how many there are in succession; sigmas: how far outside, NaN behind the camera.
  int miss_gate(CameraId camera, const ServerTrack& track, double sigmas);
  void pass_gate(const ServerTrack& track) { mutable_track(track).gate_failures = 0; }
  // figures: number of moving and of resting tracks around it.
  void set_motion(CameraId camera, const ServerTrack& track, TrackMotion motion, Figures figures = {});
  // Notes that a track that moves now went along with its camera before, from that set on.
  void mark_co_moving(const ServerTrack& track, SetId first_set) { mutable_track(track).co_moving_since = first_set; }
  // Postpones mapping the track until that set.
  void map_not_before(const ServerTrack& track, SetId set) { mutable_track(track).mapping_after = set.value; }

  void end_track(CameraId camera, ServerTrack& track, Why why);

 private:
  void let_go(CameraId camera, ServerTrack& track);
};

}  // namespace coslam
