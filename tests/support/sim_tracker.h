// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "agent/track/feature_tracker.h"
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
  double focal_error = 0;   // share by which the calibration has it too long

  CameraModel calibration() const;
};

// The tracker of one agent run: of an image its number and time count, what it shows is in the world. Points of low
// number are the strongest features.
class SimTracker final : public FeatureTracker {
 public:
  SimTracker(const SimWorld& world, CameraPath path, const TrackingConfig& config, std::string name, RunId run);

  // Places are on the grid of quantised_px().
  const std::vector<Track>& step(const Image& image) override;
  const std::vector<Track>& live() const override { return tracks_; }
  void thin(int at_most) override;
  std::vector<ImagePatch> patches(const std::vector<TrackId>& tracks) override;
  std::function<StartTracks()> describe_strongest(int most) override;
  std::function<DescribedTracks()> describe_at(const std::vector<TrackId>& wanted, int most) override;
  std::vector<TagObservation> tags() override;

  // A printed tag, seen with the noise of the tracks when it is all in view. The same one may hang in several places.
  void hang(TagId tag, const std::array<Eigen::Vector3d, 4>& corners) { tags_.emplace(tag, corners); }

  // What an agent without a pose would send, for the tests of one part of the server. Frames in order; answers are
  // about the newest.
  TrackFrame observe(FrameId frame, TimeNs t_ns);
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
    int point = -1;
    Eigen::Vector2d offset_px = Eigen::Vector2d::Zero(), slide_px = Eigen::Vector2d::Zero();
  };
  std::optional<Eigen::Vector2d> seen_at(int point) const;
  bool may_start(int point) const;
  void follow();
  void start(int point, const Eigen::Vector2d& px);
  void end(TrackId track);
  DescribedTracks start_strongest(int most, int most_new);
  DescribedTracks described(std::vector<TrackId> tracks);
  std::optional<TagObservation> see(TagId tag, const std::array<Eigen::Vector3d, 4>& corners);
  double gauss() { return normal_(random_); }
  double chance() { return std::uniform_real_distribution<>(0, 1)(random_); }

  const SimWorld& world_;
  CameraPath path_;
  TimeNs clock_behind_ns_ = 0;
  TrackingConfig config_;
  std::string name_;
  RunId run_;
  CameraModel camera_;
  double pixel_scale_;
  std::multimap<TagId, std::array<Eigen::Vector3d, 4>> tags_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  FrameId frame_;  // the newest image's
  TimeNs t_ns_ = 0;
  Rigid3 pose_;  // camera from world
  std::uint32_t next_track_ = 1;
  std::vector<Track> tracks_;
  std::map<TrackId, Live> live_;
  std::map<int, TrackId> track_of_;
  std::map<TrackId, int> point_of_;
  std::vector<std::uint32_t> birth_after_;  // per point: frame
};

}  // namespace coslam::test
