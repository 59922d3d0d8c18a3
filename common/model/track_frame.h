// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/geometry/camera_model.h"
#include "common/geometry/lens_correction.h"
#include "common/geometry/rigid3.h"
#include "common/model/pose_covariance.h"

// The plain values that agents and server exchange. Numbers are held at wire precision, so that a run in one process
// and a run over DDS compute with the same bits.
namespace coslam {

// Coordinates travel as int16 in units of pixel / pixel_scale(camera).
double pixel_scale(const CameraModel& camera);                                      // a power of two
Eigen::Vector2f quantised_px(const Eigen::Vector2d& undistorted_px, double scale);  // clamped to the int16 range

struct TrackObservation {
  TrackId track;
  Eigen::Vector2f undistorted_px = Eigen::Vector2f::Zero();  // on the grid of quantised_px()
  friend bool operator==(const TrackObservation&, const TrackObservation&) = default;
};

// Tracks that are undistorted by the calibration alone, where the lens has them; off the grid, and without those that
// it has no place for.
std::vector<TrackObservation> seen_through(const CameraModel& camera, const LensCorrection& lens,
                                           const std::vector<TrackObservation>& tracks);

// A printed square tag. The corners go round clockwise as it was printed, from the upper left one.
struct TagObservation {
  TagId tag;
  std::array<Eigen::Vector2f, 4> undistorted_px;  // on the grid of quantised_px()
  friend bool operator==(const TagObservation&, const TagObservation&) = default;
};
// Limits of what one frame may carry.
constexpr std::size_t kMaxTracks = 2048;
constexpr std::size_t kMaxTags = 16;

enum class PoseState : std::uint8_t {
  kNone,     // never placed in the map
  kTracked,  // cam_from_world and its covariance are valid
  kLost,     // was placed; the pose is the last good one and must not be used
};

// Descriptors of a frame's image travel apart, see DescriptorReply: along with it, or when the link has room.
enum class DescriptorsSent : std::uint8_t { kNone, kWithFrame, kLater };

// One image of one agent, complete in itself: a track missing from it has ended or is out of view.
struct TrackFrame {
  std::string agent;  // name, at most 32 characters
  RunId agent_run;
  FrameId frame;
  TimeNs capture_ns = 0;
  TimeNs clock_set_ns = 0;  // change of the time of day since the agent began; capture_ns does not follow it

  PoseState pose_state = PoseState::kNone;
  RunId server_run;  // run of the server whose map the pose is in; 0 before the first patch
  MapEpoch epoch;    // the map epoch in which the pose is expressed
  Rigid3 cam_from_world;
  // Order of retract(): rotation, translation; as quantised_pose_covariance() leaves it. In the map, with what its
  // points are wrong together; not how far the map as a whole is off.
  PoseCovariance pose_covariance = PoseCovariance::Zero();
  bool on_own_points = false;  // the pose also rests on points that the server does not have
  std::uint16_t pose_inliers = 0;
  float hull_fraction = 0.0f;  // convex hull of the inliers over the image area

  std::uint32_t applied_patch = 0;  // sequence number of the last map patch processed, 0 = none
  bool wants_snapshot = false;      // a patch was missed: send everything bound to my tracks again
  bool images_doubted = false;      // the images of this camera are not to be believed now, see AgentStatus
  bool narrow_link = false;         // my link carries little: map patches of one datagram
  std::uint16_t patches_sent = 0;   // image patches that travel apart for this frame, see PatchReply
  DescriptorsSent descriptors_sent = DescriptorsSent::kNone;
  std::vector<TrackObservation> tracks;  // ascending track id
  std::vector<TagObservation> tags;      // ascending, not of every image; one printed twice may be there twice
};

// Square of grey values around a track, from the raw image scaled to 30 %, mean and gain removed by the receiver.
constexpr int kPatchSide = 11;
constexpr int kPatchBytes = kPatchSide * kPatchSide;
using PatchGrey = std::array<std::uint8_t, kPatchBytes>;

struct ImagePatch {
  TrackId track;
  PatchGrey grey{};  // grey values as quantised_patch() leaves them
};

// The wire carries 4 bits a pixel: grey values in steps of 2^shift, the finest in which a patch spans at most 16 steps.
// Values at the middle of their steps; quantising twice changes nothing.
constexpr int kPatchSteps = 16;
int patch_shift(const PatchGrey& grey);
PatchGrey quantised_patch(const PatchGrey& grey);

// Position of a part in a reply: the wire carries replies in parts, see common/wire/reply_parts.h.
struct ReplyPart {
  std::uint16_t number = 0, count = 1;
};

struct PatchReply {  // answer to MapPatch::patch_requests, cut from the image of `frame`
  std::string agent;
  RunId agent_run;
  FrameId frame;
  std::vector<ImagePatch> patches;
  ReplyPart part = {};
};

// SIFT descriptors of one image (OpenCV, 128 bytes, RootSIFT-normalised by the receiver).
constexpr int kDescriptorBytes = 128;

// The wire carries 4 bits a value: which of the squares 0, 1, 4 ... 225 is nearest in the square root, which RootSIFT
// takes anyway.
std::uint8_t descriptor_step(std::uint8_t value);
inline std::uint8_t quantised_descriptor(std::uint8_t value) {
  const std::uint8_t step = descriptor_step(value);
  return static_cast<std::uint8_t>(step * step);
}

struct DescriptorReply {
  std::string agent;
  RunId agent_run;
  FrameId frame;
  std::vector<TrackId> tracks;            // ascending; each starts or goes on at its feature in this frame
  std::vector<std::uint8_t> descriptors;  // kDescriptorBytes each, as quantised_descriptor() leaves them
  ReplyPart part = {};
};

}  // namespace coslam
