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

// Between frames, while there is only one.
inline constexpr double kUsualInterval_s = 1.0 / 30;
// Frames below which a window of time tells nothing.
inline constexpr int kLeastFrames = 3;
// Between images, from which on few of them show the same.
inline constexpr double kSeldom_s = 0.4;

// Where one camera was at one frame set.
struct FramePose {
  SetId set;
  FrameId frame;
  TimeNs capture_ns = 0;
  MapId map;  // whose frame the pose is in; 0 = no pose
  Rigid3 cam_from_world;
  bool joint = false;           // rests on moving points or on its agent's word too: the static ones would not hold it
  std::vector<HeldTrack> held;  // some tracks, spread over the image, to solve the pose again when all is known
  float zoom_taken_out = 0;     // of what it observed, see MapEdit::leave_zoom_out()

  bool valid() const { return map != MapId(); }
};
auto fields(Like<FramePose> auto& f) {
  return std::tuple(kept("set", f.set), kept("frame", f.frame), instant("capture_ns", f.capture_ns), kept("map", f.map),
                    kept("cam_from_world", f.cam_from_world), kept("joint", f.joint), kept("held", f.held),
                    kept("zoom_taken_out", f.zoom_taken_out, 3));
}

// Frames of a camera that memory holds no more, see server/estimator/map/past.h.
struct PastFramesCount {
  SetId until;  // those before it; some are in memory all the same, the others hang on them
  int frames = 0;
  std::map<MapId, int> placed;                  // frames with a pose, by the map they are in now
  TimeNs first_ns = 0;                          // capture of the first
  std::vector<std::pair<TimeNs, TimeNs>> lost;  // from when to when it had no pose
};
auto fields(Like<PastFramesCount> auto& p) {
  return std::tuple(kept("until", p.until), kept("frames", p.frames), kept("placed", p.placed),
                    instant("first_ns", p.first_ns), instant("lost", p.lost));
}

// An epoch that an agent was told of, and how its world was moved since.
struct AnnouncedEpoch {
  MapEpoch epoch;
  Similarity3 moved;
};
auto fields(Like<AnnouncedEpoch> auto& t) { return std::tuple(kept("epoch", t.epoch), kept("moved", t.moved)); }

struct MapCamera {
  CameraId id;
  std::string name;
  RunId run;
  CameraModel model;     // as calibrated
  LensCorrection lens;   // what is wrong about that; all that was observed is undistorted with it
  double breathing = 0;  // by how much its focal length was found to change from image to image, most; 0: not known to
  LensCorrection::Values lens_sigma = LensCorrection::Values::Zero();  // of its values; 0: as calibrated
  double sigma_px = 1.0;   // measured standard deviation of its observations
  int sigma_frames = 0;    // that it was measured in
  std::string rig;         // name of the first camera of the rig that it is fixed to; empty: it is free
  Rigid3 cam_from_rig;     // metres
  MapId map;               // that it is being localised in; 0 = not placed
  bool corrected = false;  // its pose in this set rests on more than its agent has: the agent is to take it
  double scene_depth = 0;  // median of what it saw with its newest good pose; 0: not known yet
  bool sparse = false;     // it sees so few proven points for long that it has to use the others too
  int lost_sets = 0;       // frame sets in succession without a pose, while it has a map
  Similarity3 moved;       // how its world was moved since the last patch to its agent
  std::deque<AnnouncedEpoch> announced;  // of its present map, the newest ones
  MapId merged_from;  // the map that it was in then and that became part of its present one; 0 = no merge
  bool alive = true;
  SetId run_since;                             // of the frames of this run of its agent
  TimeNs clock_offset_ns = 0;                  // its images were taken so much later than they are dated
  double frame_interval_s = kUsualInterval_s;  // median of its newest ones
  std::vector<FramePose> frames;               // ascending sets, the whole run but for what is past
  PastFramesCount past;
  FlatMap<TrackId, ServerTrack> tracks;  // live ones; pointers hold until the next frame set

  Eigen::Vector2d raw_px(const Eigen::Vector2d& undistorted_px) const {
    return lens.raw_from_undistorted(model, undistorted_px);
  }
  const FramePose* frame_at(SetId set) const;
  // How its world was moved since an epoch that its agent speaks of; empty when that is too long ago, or of another
  // map.
  std::optional<Similarity3> moved_since(MapEpoch epoch) const;
  // Those that are not past.
  std::span<const FramePose> present_frames() const;
  std::size_t frames_ever() const { return static_cast<std::size_t>(past.frames) + present_frames().size(); }
  // Of all frames ever, those with a pose in this map.
  int frames_in_map(MapId in) const;
  // How many of its frames come in that time, by the newest ones; at least so many.
  int frames_in(double time_s, int least = 1) const;
  // Its images are so seldom that few things are in more than three.
  bool seldom() const { return frame_interval_s >= kSeldom_s; }
  // Of a track, to go by it.
  int least_views() const { return seldom() ? 2 : kLeastFrames; }
  TimeNs taken_ns(const FramePose& frame) const { return frame.capture_ns + clock_offset_ns; }
  // Pose at an instant near that set, in between the frame there and the one before when the image was taken at another
  // time; empty without poses in one map.
  std::optional<Rigid3> pose_at(SetId set, TimeNs t_ns) const;
  // What it would have seen at that instant, pose and pixel, by what it saw at the set. Empty without a pose in `in`.
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
      not_kept("corrected", c.corrected),                     // of the newest set
      not_kept("announced", c.announced),                     // its agent has to be told anew
      not_kept("alive", c.alive));                            // until it is heard
}

}  // namespace coslam
