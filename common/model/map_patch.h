// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/geometry/lens_correction.h"
#include "common/geometry/rigid3.h"

namespace coslam {

enum class PointState : std::uint8_t { kStatic, kUncertain, kDynamic };

// A map point bound to one of the agent's tracks; with no point (0), and kUncertain, the direction of a track that has
// none (far_point()).
struct BoundPoint {
  TrackId track;
  PointId point;
  PointState state = PointState::kStatic;
  Eigen::Vector3f position = Eigen::Vector3f::Zero();                          // map frame, metres when scale_known
  Eigen::Matrix<float, 6, 1> covariance = Eigen::Matrix<float, 6, 1>::Zero();  // xx xy xz yy yz zz

  bool is_direction() const { return state == PointState::kUncertain && point == PointId(); }
  // Agents rest on it: it has a place. Of others the wire carries none.
  bool has_place() const { return state == PointState::kStatic || is_direction(); }
};

Eigen::Matrix3d unpack_covariance(const Eigen::Matrix<float, 6, 1>& packed);
Eigen::Matrix<float, 6, 1> pack_covariance(const Eigen::Matrix3d& covariance);

// The pose that the server gives an agent for one of its frames (start, re-placing, correction).
struct PlacedPose {
  FrameId frame;
  Rigid3 cam_from_world;  // in the epoch of the patch
};

// Selects the features of the next image that an agent is to describe.
enum class DescriptorRequest : std::uint8_t {
  kNone,
  kAtTracks,    // features at its tracks: enough for place recognition
  kEverywhere,  // the strongest of the image, which become tracks: to start a map, to be placed, to join another map
};

// The map of a server goes on in another one, from that epoch on.
struct ContinuedMap {
  RunId server_run;
  MapEpoch epoch;
  friend bool operator==(const ContinuedMap&, const ContinuedMap&) = default;
};

// Everything the server tells one agent after one frame set, applied by the agent in one step.
struct MapPatch {
  std::string agent;
  RunId server_run;
  RunId agent_run;             // addressee; another run ignores it
  std::uint32_t sequence = 0;  // 1, 2, ... for a pair of runs; a gap makes the agent ask for a snapshot
  FrameId after_frame;         // the agent's newest frame that this patch has seen; the credit of lock-step replay
  bool snapshot = false;       // `updated` is the whole local map: forget all other bindings
  MapEpoch epoch;              // epoch of every position and pose in here
  Similarity3 new_from_old;    // maps the epoch before to `epoch`; identity when the epoch did not change
  std::optional<ContinuedMap> continues;  // while the agent speaks of the map of a server before this one
  std::optional<PlacedPose> placed;
  std::optional<LensCorrection> lens;   // float; nothing: as before, in a snapshot: as calibrated
  std::vector<BoundPoint> updated;      // new bindings and new positions
  std::vector<TrackId> unbound;         // tracks that no longer have a point
  std::vector<TrackId> patch_requests;  // answer with PatchReply at the next frame
  DescriptorRequest descriptor_request = DescriptorRequest::kNone;  // answer with DescriptorReply at the next frame
  GroupId group;
  bool scale_known = false;
  TimeNs sent_ns = 0;       // clock of the server; 0 in lock-step
  float uplink_wait_s = 0;  // how much longer than at best the agent's newest frame was under way
  TimeNs received_ns = 0;   // clock of the agent, UTC; not on the wire
};

}  // namespace coslam
