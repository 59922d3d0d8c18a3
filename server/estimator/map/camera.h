// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "common/base/fields.h"
#include "common/base/flat_map.h"
#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/geometry/camera_model.h"
#include "common/geometry/lens_correction.h"
#include "common/geometry/rigid3.h"
#include "common/geometry/triangulation.h"
#include "server/estimator/map/track.h"

namespace coslam {

// Assumed time between frames while there is only one.
inline constexpr double kUsualInterval_s = 1.0 / 30;
// Least number of frames in a window of time that tells something.
inline constexpr int kLeastFrames = 3;
// Time between images from which on few of them show the same.
inline constexpr double kSeldom_s = 0.4;

// Pose of a camera at one frame set.
struct FramePose {
  SetId set;
  FrameId frame;
  TimeNs capture_ns = 0;
  MapId map;  // map that the pose is in; 0 = no pose
  Rigid3 cam_from_world;
  bool joint = false;  // rests on moving points or on the agent's pose too: the static points would not determine it
  std::vector<HeldTrack> held;  // some tracks, spread over the image, to solve the pose again when all is known
  float zoom_taken_out = 0;     // zoom that its observations were corrected for, see MapEdit::leave_zoom_out()

  bool valid() const { return map != MapId(); }
};
auto fields(Like<FramePose> auto& f) {
  return std::tuple(kept("set", f.set), kept("frame", f.frame), instant("capture_ns", f.capture_ns), kept("map", f.map),
                    kept("cam_from_world", f.cam_from_world), kept("joint", f.joint), kept("held", f.held),
                    kept("zoom_taken_out", f.zoom_taken_out, 3));
}

// Archived frames of a camera, which memory no longer holds, see server/estimator/map/past.h.
struct PastFramesCount {
  SetId until;  // first set that is not archived; some earlier frames stay in memory, the others are anchored to them
  int frames = 0;
  std::map<MapId, int> placed;                  // frames with a pose, by the map they are in now
  TimeNs first_ns = 0;                          // capture time of the first frame
  std::vector<std::pair<TimeNs, TimeNs>> lost;  // begin and end of each time without a pose
};
auto fields(Like<PastFramesCount> auto& p) {
  return std::tuple(kept("until", p.until), kept("frames", p.frames), kept("placed", p.placed),
                    instant("first_ns", p.first_ns), instant("lost", p.lost));
}

// Epoch that an agent was told of, and how its world was moved since.
struct AnnouncedEpoch {
  MapEpoch epoch;
  Similarity3 moved;
};
auto fields(Like<AnnouncedEpoch> auto& t) { return std::tuple(kept("epoch", t.epoch), kept("moved", t.moved)); }

// Who a camera is: an agent's name, and the run of it that is heard.
struct CameraIdentity {
  CameraId id;
  std::string name;
  RunId run;
  SetId run_since;  // first set of this run of its agent
  bool alive = true;
  std::string rig;      // name of the first camera of the rig that it is fixed to; empty: it is free
  Rigid3 cam_from_rig;  // metres
};

// How a camera's images are formed, and how exactly its tracks were measured in them.
struct CameraLens {
  CameraModel model;     // calibration
  LensCorrection lens;   // correction of the calibration; all observations are undistorted with it
  double breathing = 0;  // largest change of its focal length found from image to image, as a share; 0: none known
  LensCorrection::Values lens_sigma = LensCorrection::Values::Zero();  // sigmas of lens.values; 0: as calibrated
  double sigma_px = 1.0;                                               // measured standard deviation of observations
  int sigma_frames = 0;                                                // frames in which sigma_px was measured

  Eigen::Vector2d raw_px(const Eigen::Vector2d& undistorted_px) const {
    return lens.raw_from_undistorted(model, undistorted_px);
  }
};

// How a camera stands to the map that it is localised in, and what its agent was told of that map.
struct CameraLocalisation {
  MapId map;                             // map in which it is localised; 0 = not placed
  bool corrected = false;                // newest pose rests on more than the agent has, which is to take it
  double scene_depth = 0;                // median of what it saw with its newest good pose; 0: not known yet
  bool sparse = false;                   // sees so few proven points, for long, that it has to use those on trial too
  int lost_sets = 0;                     // successive frame sets without a pose, while it has a map
  Similarity3 moved;                     // change of its world since the last patch to its agent
  std::deque<AnnouncedEpoch> announced;  // newest epochs of its present map
  MapId merged_from;  // map at the last patch to its agent, if that map became part of the present one since; 0 = none

  // Returns how its world was moved since an epoch that its agent knows; empty when that is too long ago, or of another
  // map.
  std::optional<Similarity3> moved_since(MapEpoch epoch) const;
};

// Frames of a camera, with their poses, and when they were taken.
struct CameraFrames {
  TimeNs clock_offset_ns = 0;                  // images were taken later than dated by this much
  double frame_interval_s = kUsualInterval_s;  // median of the newest intervals
  std::vector<FramePose> frames;               // sorted by set, without archived ones
  PastFramesCount past;

  const FramePose* frame_at(SetId set) const;
  // Frames that are not archived.
  std::span<const FramePose> present_frames() const;
  std::size_t frames_ever() const { return static_cast<std::size_t>(past.frames) + present_frames().size(); }
  // Number of all frames, also archived ones, with a pose in this map.
  int frames_in_map(MapId in) const;
  // Number of its frames in that time, by the newest ones; at least `least`.
  int frames_in(double time_s, int least = 1) const;
  // True when its images are so rare that few things are in more than three.
  bool seldom() const { return frame_interval_s >= kSeldom_s; }
  // Least views of a track for it to be used.
  int least_views() const { return seldom() ? 2 : kLeastFrames; }
  TimeNs taken_ns(const FramePose& frame) const { return frame.capture_ns + clock_offset_ns; }
  // Pose at an instant near that set, interpolated between the frame there and the one before when the image was taken
  // at another time; empty without poses in one map.
  std::optional<Rigid3> pose_at(SetId set, TimeNs t_ns) const;
};

// A camera of the map: four parts, for functions that ask for one of them, and its live tracks.
struct MapCamera : CameraIdentity, CameraLens, CameraLocalisation, CameraFrames {
  using Parts = std::tuple<CameraIdentity, CameraLens, CameraLocalisation, CameraFrames>;

  FlatMap<TrackId, ServerTrack> tracks;  // pointers are valid until the next frame set

  // Predicts the view of a sighting at another instant, pose and pixel. Empty without a pose in `in`.
  std::optional<View> view_at(MapId in, SetId set, const Sighting& seen, TimeNs t_ns) const;
};
auto fields(Like<MapCamera> auto& c) {
  return std::tuple(
      kept("id", c.id), kept("name", c.name), kept("run", c.run), kept("model", c.model), kept("sigma_px", c.sigma_px),
      kept("sigma_frames", c.sigma_frames), kept("rig", c.rig), kept("cam_from_rig", c.cam_from_rig),
      kept("map", c.map), kept("scene_depth", c.scene_depth), kept("sparse", c.sparse), kept("lost_sets", c.lost_sets),
      kept("moved", c.moved), kept("merged_from", c.merged_from), kept("clock_offset_ns", c.clock_offset_ns),
      kept("frame_interval_s", c.frame_interval_s), kept("run_since", c.run_since), kept("tracks", c.tracks),
      kept("lens", c.lens, 3), kept("breathing", c.breathing, 3), kept("lens_sigma", c.lens_sigma, 3),
      kept("past", c.past, 3), not_kept("frames", c.frames),  // rows of their own
      not_kept("corrected", c.corrected),                     // belongs to the newest set
      not_kept("announced", c.announced),                     // the agent is told anew
      not_kept("alive", c.alive));                            // unknown until its agent is heard
}

}  // namespace coslam
