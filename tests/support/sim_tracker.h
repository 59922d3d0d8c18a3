// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "common/model/session.h"
#include "common/model/track_frame.h"
#include "tests/support/sim_world.h"

namespace coslam::test {

struct TrackingConfig {
  double noise_px = 0.3;    // standard deviation of one coordinate, independent from frame to frame
  double outliers = 0;      // share of the observations that are 8 to 40 px off
  double ends = 0;          // chance that a track ends at a frame
  int rebirth_frames = 4;   // until the point of an ended track is followed again, as another track
  int max_tracks = 250;     // at once
  double border_px = 4;     // tracks end so close to the border
  double max_depth_m = 30;  // nothing is seen beyond
};

// What the tracker of one agent run makes of the world: tracks, patches and descriptors, as they go over the wire.
class SimTracker {
 public:
  SimTracker(const SimWorld& world, CameraPath path, const TrackingConfig& config, std::string name, RunId run);

  // The tracks of one image; the frame's pose stays kNone. Frames in order.
  TrackFrame observe(FrameId frame, TimeNs t_ns);
  // A printed tag in the image of that time, with the noise of the tracks; empty when it is not all in view.
  std::optional<TagObservation> see(TagId tag, const std::array<Eigen::Vector3d, 4>& corners, TimeNs t_ns);
  // Answers about the newest frame.
  PatchReply cut(const TrackFrame& frame, const std::vector<TrackId>& wanted);
  DescriptorReply describe(const TrackFrame& frame);

  // Images are dated so much earlier than they are taken.
  void set_clock_behind(TimeNs behind_ns) { clock_behind_ns_ = behind_ns; }
  Rigid3 truth(TimeNs t_ns) const { return path_(to_seconds(t_ns + clock_behind_ns_)); }  // cam_from_world, as dated
  Hello hello() const;
  const std::string& name() const { return name_; }
  RunId run() const { return run_; }

  // Of every track that ever was; -1 for an unknown one.
  int point_of(TrackId track) const;
  // The live track of a point.
  std::optional<TrackId> track_of(int point) const;
  // From now on the track drifts off its point.
  void slide(TrackId track, const Eigen::Vector2d& px_per_frame);

 private:
  struct Live {
    int point;
    Eigen::Vector2d offset_px = Eigen::Vector2d::Zero(), slide_px = Eigen::Vector2d::Zero();
  };
  std::optional<Eigen::Vector2d> seen_at(const Rigid3& pose, int point, TimeNs t_ns) const;
  double gauss() { return normal_(random_); }
  double chance() { return std::uniform_real_distribution<>(0, 1)(random_); }

  const SimWorld& world_;
  CameraPath path_;
  TimeNs clock_behind_ns_ = 0;
  TrackingConfig config_;
  std::string name_;
  RunId run_;
  CameraModel camera_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::uint32_t next_track_ = 1;
  std::map<TrackId, Live> live_;
  std::map<int, TrackId> track_of_;
  std::map<TrackId, int> point_of_;
  std::vector<std::uint32_t> birth_after_;  // per point: frame
};

}  // namespace coslam::test
