// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/map/pen.h"

namespace coslam {

// Verbs on tracks: which point each shows, and what speaks against that.
class TrackPen : public MapPen {
 protected:
  using MapPen::MapPen;

  // Binds a track to a point, with its observations at key frames so far and its patch.
  void bind(const MapPoint& to, CameraId camera, const ServerTrack& of, Why why, Figures figures = {});
  // Binds a track to a moving point, which lies offset_px from the track in the image. The track's views so far say
  // nothing about where the point is now.
  void bind_moving(const MapPoint& point, CameraId camera, const ServerTrack& track, const Eigen::Vector2f& offset_px,
                   Why why, Figures figures = {});
  void unbind(CameraId camera, const ServerTrack& of, Why why, Figures figures = {});
  // The track's image patch becomes one of the point's.
  void give_patch(const MapPoint& point, CameraId camera, const ServerTrack& track);
  // What the track saw before this set is not used any more.
  void distrust_before(const ServerTrack& track, SetId set) { own(track).distrusted_before = set.value; }
  // Counts a gate failure and returns how many there are in succession; sigmas: how far outside, NaN behind the camera.
  int miss_gate(CameraId camera, const ServerTrack& track, double sigmas);
  void pass_gate(const ServerTrack& track) { own(track).gate_failures = 0; }
  // figures: of the tracks around it, how many move and how many rest.
  void set_motion(CameraId camera, const ServerTrack& track, TrackMotion motion, Figures figures = {});
  // A track that moves now went along with its camera before, since that set.
  void mark_co_moving(const ServerTrack& track, SetId since) { own(track).co_moving_since = since; }
  // Mapping the track is not tried before that set.
  void map_not_before(const ServerTrack& track, SetId set) { own(track).mapping_after = set.value; }

  void end_track(CameraId camera, ServerTrack& track, Why why);

 private:
  void let_go(CameraId camera, ServerTrack& track);
};

}  // namespace coslam
