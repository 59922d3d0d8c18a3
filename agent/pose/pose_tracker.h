// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <vector>

#include "agent/correct/local_map.h"
#include "agent/pose/own_map.h"
#include "common/geometry/camera_model.h"
#include "common/geometry/pose_refinement.h"
#include "common/geometry/steady_motion.h"
#include "common/model/track_frame.h"

namespace coslam {

struct PoseTrackerConfig {
  double sigma_px = 3.0;          // noise of detection and tracking, at 640 px image width
  int min_inliers = 12;           // fewer: lost
  double min_inlier_ratio = 0.3;  // share of the static points seen; fewer: lost
};

// Estimates the agent's pose frame by frame from the static points bound to its tracks (paper 4.1). Keeps a short
// history of its own poses so that a pose that the server gives for an earlier frame can be carried to now. Where
// points are few, the motion model continues. Alone, the pose rests on points of the agent's own as well.
class PoseTracker {
 public:
  PoseTracker(const CameraModel& camera, const PoseTrackerConfig& config);

  // Estimates the pose of `frame`. `tracks` are its undistorted tracks. alone: the server has been silent for a while.
  // From then on it rests on points of its own, until enough of the server's agree with its pose.
  void step(FrameId frame, TimeNs capture_ns, const std::vector<TrackObservation>& tracks, const LocalMap& map,
            bool alone = false);
  // The map moved under the agent: every pose so far is re-expressed. What was published stays published.
  void rebase(const Similarity3& new_from_old);
  // The server's pose for an earlier frame; the motion since then is kept when it is known.
  void place(const PlacedPose& placed);
  // Tracks come through another lens from now on: what they were seen at before is forgotten.
  void change_lens() { own_map_.clear(); }
  // Starts from nothing, for another server.
  void reset();

  PoseState state() const { return state_; }
  const PoseResult& result() const { return result_; }  // result of the newest step
  bool on_own_points() const { return alone_; }         // rests on points of its own too
  double inlier_hull_fraction() const { return hull_; }

 private:
  // Time since the newest pose; empty after a gap.
  std::optional<double> steady_s(TimeNs capture_ns) const;
  void follow(TimeNs capture_ns);
  struct KnownPoints {
    std::vector<PointObservation> observations;
    std::vector<bool> from_server;  // whether the server says that the point is static
  };
  KnownPoints known_points(const std::vector<TrackObservation>& tracks, const LocalMap& map) const;

  CameraModel camera_;
  PoseTrackerConfig config_;
  PoseState state_ = PoseState::kNone;
  PoseResult result_;
  double hull_ = 0;
  OwnMap own_map_;
  SteadyMotion motion_;
  bool alone_ = false;
  int told_agree_ = 0;  // points of a server that speaks, at the newest step
  struct Past {
    FrameId frame;
    std::optional<TimeNs> capture_ns;  // unknown for a placed pose
    Rigid3 cam_from_world;
  };
  std::deque<Past> past_;  // newest last, successive good poses
};

}  // namespace coslam
