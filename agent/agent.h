// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "agent/correct/local_map.h"
#include "agent/pose/own_body.h"
#include "agent/pose/pose_tracker.h"
#include "agent/pose/rolling_shutter.h"
#include "agent/track/feature_tracker.h"
#include "agent/track/image.h"
#include "agent/track/tags.h"
#include "agent/track/tracker.h"
#include "common/base/metrics.h"
#include "common/geometry/lens_correction.h"
#include "common/model/map_patch.h"
#include "common/model/track_frame.h"

namespace coslam {

struct AgentConfig {
  TrackerConfig tracker;
  PoseTrackerConfig pose;
  int descriptor_features = 310;  // maximum, in a reply to a request for descriptors everywhere
  int place_features = 160;       // maximum, in a reply to a request for descriptors at tracks
  TagConfig tags;
  bool thumbnails = true;  // a small image goes to the server when somebody at the live page asks for one
  double readout_s = -1;   // readout time of a rolling shutter, from the first row to the last; negative: estimated
};

// Limits how much of what the server asked for goes with an image; the rest waits for a later one.
struct Answers {
  std::size_t patches = kMaxTracks;                 // maximum number of patches
  int described = std::numeric_limits<int>::max();  // most features; 0: none, the request waits
  bool later = false;                               // images are described after their frame, see AgentOutput::describe

  static constexpr Answers all() { return {}; }
  static constexpr Answers none() { return {.patches = 0, .described = 0}; }
};

// Describing an image takes longer than all else: the work may be done in any thread.
using DescribeEnd = std::function<DescriptorReply()>;
using DescribeWork = std::function<DescribeEnd()>;

// Messages that an agent sends for one image.
struct AgentOutput {
  TrackFrame frame;
  std::optional<PatchReply> patches;
  std::optional<DescriptorReply> descriptors;
  DescribeWork describe;  // instead of them, if they come later
};

// The tracker that agents use: the one place that says which.
std::unique_ptr<FeatureTracker> make_feature_tracker(const CameraModel& camera, const AgentConfig& config);

// One camera's agent: images in, tracks and pose out. Owns no thread and uses no network; reads the clock only for
// times(). Pixels are the tracker's. One step is track(image), which does not depend on the map and so runs while the
// server still thinks, then finish(patches).
class Agent {
 public:
  static constexpr const char* kFrame = "frame";  // stage in times() that is all of the agent's work for an image

  Agent(std::string name, RunId run, const CameraModel& camera, const AgentConfig& config,
        std::unique_ptr<FeatureTracker> tracker);

  void track(const Image& image);
  // Finishes a description between track() and finish(); its reply goes with this frame.
  DescriptorReply take(const DescribeEnd& end);
  AgentOutput finish(std::span<const MapPatch> patches, Answers answers = {});
  // Describes the features of the newest image at its tracks, when the run ends. Empty without an image.
  std::optional<DescriptorReply> describe_last();
  std::optional<FrameId> described() const { return described_; }  // the newest image that was

  PoseState pose_state() const { return pose_.state(); }
  const PoseResult& pose() const { return pose_.result(); }  // pose of the newest step
  const LocalMap& local_map() const { return map_; }
  const StageTimes& times() const { return times_; }
  std::uint32_t tracked_frames() const { return tracked_frames_; }
  // Estimated readout time of a rolling shutter; 0 when it is configured.
  double found_readout_s() const { return shutter_.found_s(); }
  // Share of the picture that moves with the camera and is left out.
  double own_body_share() const { return own_body_.share(); }
  ImageParts own_body() const { return own_body_.found(); }
  // Width of the images as they are tracked in.
  int working_width_px() const;
  std::size_t tracks() const { return observations_.size(); }

 private:
  void take(const MapPatch& patch);
  void observe();
  void look_for_tags();
  DescriptorsSent describe_image(const Answers& answers, AgentOutput* out);
  DescribeWork describe_tracks(int most);
  DescribeWork describe_everywhere(int most);
  std::optional<PatchReply> cut_patches(std::size_t most);
  TrackFrame make_frame() const;
  std::vector<TrackId> observed() const;
  int room_for_described() const;

  std::string name_;
  RunId run_;
  CameraModel camera_;
  AgentConfig config_;
  double pixel_scale_;
  std::unique_ptr<FeatureTracker> tracker_;
  RollingShutter shutter_;
  OwnBody own_body_;
  PoseTracker pose_;
  LocalMap map_;

  FrameId frame_;
  TimeNs capture_ns_ = 0;
  TimeNs heard_ns_ = 0;                         // capture time of the newest image when a patch came last
  LensCorrection lens_;                         // the server's correction of the calibration
  std::vector<TrackObservation> observations_;  // live tracks that have an undistorted place, by the calibration
  std::vector<TagObservation> tags_;
  std::optional<TimeNs> tags_sought_ns_;
  std::set<TrackId> patch_requests_;
  // The first image introduces the agent.
  DescriptorRequest descriptors_wanted_ = DescriptorRequest::kEverywhere;
  int since_described_ = 0;  // images
  std::optional<FrameId> described_;
  StageTimes times_;
  std::chrono::steady_clock::duration frame_took_{};
  std::uint32_t tracked_frames_ = 0;
};

}  // namespace coslam
