// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"
#include "common/model/pose_covariance.h"
#include "common/ros/views.h"
#include "server/keep/loop_facts.h"

// The public part of the map, copied at one instant and never changed again: the map's thread copies, other threads
// encode. Its parts are separate because each has a pace of its own.
namespace coslam {

// Parts of a snapshot.
enum class Part : std::uint8_t { kPoses, kMoving, kCloud, kPaths, kTracks, kState, kEvents };
struct PartSet {
  std::uint32_t bits = 0;
  constexpr PartSet() = default;
  constexpr PartSet(Part p) : bits(1U << static_cast<std::uint32_t>(p)) {}  // NOLINT: a part is a set of one
  constexpr explicit PartSet(std::uint32_t mask) : bits(mask) {}
  constexpr bool has(Part p) const { return (bits & PartSet(p).bits) != 0; }
  constexpr PartSet& operator|=(PartSet o) {
    bits |= o.bits;
    return *this;
  }
};
inline constexpr PartSet kAllParts{0x7fU};

// Fields that all parts share.
struct PublicInstant {
  TimeNs t_ns = 0;  // capture
  MapId main;       // the map whose frame is "map"; 0: there is none yet
};

struct PublicVelocity {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();  // a second, in the camera frame
  Eigen::Vector3d angular_rad = Eigen::Vector3d::Zero();
  double over_s = 0;  // duration of the measurement
};

struct PublicPose {
  std::string agent;
  MapId map;
  TimeNs capture_ns = 0;
  Rigid3 cam_from_map;
  Rigid3 cam_from_odom;                      // see OdomFrames
  std::optional<PoseCovariance> covariance;  // covariance of cam_from_map, as the agent knows it
  std::optional<PublicVelocity> velocity;
};

// Cameras that have a pose at this instant.
struct PublicPoses : PublicInstant {
  std::vector<PublicPose> cameras;
};

// Moving points and objects at this instant, by map.
struct PublicMoving : PublicInstant {
  struct InMap {
    std::vector<ros::MovingPoint> points;
    std::vector<ros::MovingObject> objects;
  };
  std::map<MapId, InMap> maps;
};

// All points that rest, of all maps. Collected over several frame sets when there are many, so some may be a little
// older.
struct PublicCloud : PublicInstant {
  std::vector<ros::StaticPoint> points;
};

struct PublicPath {
  std::string agent;
  MapId map;
  std::vector<std::pair<TimeNs, Rigid3>> cam_from_map;  // ascending
  std::vector<Rigid3> key_cam_from_map;                 // poses of the key frames, ascending in time
};

struct PublicPaths : PublicInstant {
  std::vector<PublicPath> cameras;
};

enum class PublicTrackState : std::uint8_t { kNone, kStatic, kDynamic, kUncertain };
struct PublicTrack {
  TrackId track;
  Eigen::Vector2f undistorted_px = Eigen::Vector2f::Zero();
  PublicTrackState state = PublicTrackState::kNone;
};
struct PublicImage {
  std::string agent;
  TimeNs capture_ns = 0;
  CameraModel camera;
  std::vector<PublicTrack> tracks;
};

// Image planes.
struct PublicTracks : PublicInstant {
  std::vector<PublicImage> cameras;
};

struct PublicEvent {
  TimeNs t_ns = 0;
  std::string kind;  // merge, split, loop, lost, found, joined, left, restarted, map_started, maps_joined
  std::string text;  // a sentence
  std::vector<std::string> agents;
};

// State of an agent, see docs/live.md.
enum class PublicStanding : std::uint8_t { kNone, kTracking, kRelative, kLost, kUnheard };

struct PublicAgent {
  AgentFacts facts;
  RunId run;
  bool alive = false;
  MapId map;
  int group = -1;
  PublicStanding standing = PublicStanding::kNone;
  std::string why;  // reason why it is lost; empty when it is not
  double rate_hz = 0;
  std::uint32_t frames_due = 0,
                frames_used = 0;  // counts over its run: images taken by its camera, frames in frame sets
  std::size_t tracks = 0, bound = 0;
  std::optional<double> clock_offset_s;
  std::optional<Rigid3> cam_from_map;
  bool scale_known = false;  // scale of its map
  CameraModel camera;
};

// State of the run.
struct PublicState : PublicInstant {
  TimeNs wall_ns = 0;        // monotonic
  RunId run;                 // 0: made from a result, which has no facts about the machines
  bool scale_known = false;  // scale of the main map
  std::vector<PublicAgent> agents;
  std::vector<std::vector<std::string>> groups;
  struct Link {
    std::string first, second;
    int shared = 0;
  };
  std::vector<Link> links;
  LoopFacts loop;  // facts of the loop, but for the agents, which are above

  std::size_t points = 0, moving_points = 0, objects = 0, maps = 0, key_frames = 0;
  int frame_sets = 0, merges = 0, inter_pose_calls = 0, refinements = 0;
  std::map<std::string, StageTime> stages;  // keyed by name; "frame_set" is all of them, "view" comes on top
};

// Absent parts are not due, or nobody wants them.
struct Snapshot {
  std::shared_ptr<const PublicPoses> poses;
  std::shared_ptr<const PublicMoving> moving;
  std::shared_ptr<const PublicCloud> cloud;
  std::shared_ptr<const PublicPaths> paths;
  std::shared_ptr<const PublicTracks> tracks;
  std::shared_ptr<const PublicState> state;
  std::vector<PublicEvent> events;

  bool empty() const { return !poses && !moving && !cloud && !paths && !tracks && !state && events.empty(); }
  // Takes in a newer one.
  void update(Snapshot newer);
};

}  // namespace coslam
