// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/copies.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace coslam {
namespace {

constexpr std::size_t kMostOfPath = 500;  // poses

// Over the last tenth of a second: longer than the noise of one pose, shorter than a turn.
std::optional<PublicVelocity> velocity_of(const CameraFrames& camera) {
  constexpr double kLeast_s = 0.09, kMost_s = 0.5;
  const FramePose& now = camera.frames.back();
  for (auto before = camera.frames.rbegin() + 1; before != camera.frames.rend(); ++before) {
    const double over_s = to_seconds(now.capture_ns - before->capture_ns);
    if (over_s > kMost_s) break;
    if (over_s < kLeast_s) continue;
    if (before->map != now.map) break;
    const Eigen::Quaterniond& q = now.cam_from_world.rotation;
    return PublicVelocity{q * (now.cam_from_world.center() - before->cam_from_world.center()) / over_s,
                          so3_log(before->cam_from_world.rotation * q.conjugate()) / over_s, over_s};
  }
  return std::nullopt;
}

std::optional<Rigid3> pose_at(const CameraFrames& camera, MapId map, TimeNs capture_ns) {
  for (auto f = camera.frames.rbegin(); f != camera.frames.rend() && f->capture_ns >= capture_ns; ++f) {
    if (f->capture_ns == capture_ns && f->valid() && f->map == map) return f->cam_from_world;
  }
  return std::nullopt;
}

float sigma_of(const MapPoint& point) { return static_cast<float>(std::sqrt(point.covariance.trace())); }

PublicTrackState state_of(const Map& map, const ServerTrack& track) {
  if (track.moves()) return PublicTrackState::kDynamic;
  if (!track.bound()) return PublicTrackState::kNone;
  const MapPoint* point = map.find(track.point);
  if (point == nullptr) return PublicTrackState::kNone;
  if (point->moves()) return PublicTrackState::kDynamic;
  return point->proven() ? PublicTrackState::kStatic : PublicTrackState::kUncertain;
}

ros::StaticPoint static_point(const MapPoint& p) {
  constexpr std::uint32_t kMostViews = std::numeric_limits<std::uint16_t>::max();
  return {.position = p.position.cast<float>(),
          .sigma = sigma_of(p),
          .id = p.id,
          .map = p.map,
          .on_trial = !p.proven(),
          .views = static_cast<std::uint16_t>(std::min(p.views, kMostViews))};
}

// Thinned by powers of two: the same ones each time, until there are twice as many.
std::vector<Rigid3> key_poses_of(const Map& map, const MapCamera& camera) {
  constexpr std::size_t kMost = 500;
  std::size_t stride = 1;
  while (map.key_frames().size() / stride > kMost) stride *= 2;
  std::vector<Rigid3> out;
  auto frame = camera.frames.begin();  // both ascend
  for (std::size_t i = 0; i < map.key_frames().size(); i += stride) {
    const SetId set = map.key_frames()[i].set;
    frame = std::lower_bound(frame, camera.frames.end(), set, [](const FramePose& f, SetId s) { return f.set < s; });
    if (frame == camera.frames.end()) break;
    if (frame->set == set && frame->valid() && frame->map == camera.map) out.push_back(frame->cam_from_world);
  }
  return out;
}

PublicPath path_of(const Map& map, const MapCamera& camera) {
  constexpr std::size_t kNewest = kMostOfPath / 2;
  const auto& frames = camera.frames;
  PublicPath path{.agent = camera.name, .map = camera.map};
  // A power of two, and counted from the start: the same poses each time, until there are twice as many.
  std::size_t stride = 1;
  while (frames.size() / stride > kMostOfPath - kNewest) stride *= 2;
  const std::size_t newest = frames.size() - std::min(frames.size(), kNewest);
  const auto add = [&](const FramePose& f) {
    if (f.valid() && f.map == camera.map) path.cam_from_map.emplace_back(f.capture_ns, f.cam_from_world);
  };
  for (std::size_t i = 0; i < newest; i += stride) add(frames[i]);
  for (std::size_t i = newest; i < frames.size(); ++i) add(frames[i]);
  path.key_cam_from_map = key_poses_of(map, camera);
  return path;
}

}  // namespace

PublicPoses copy_poses(const Map& map, const FrameSet& set, RunId server_run, OdomFrames* odom) {
  PublicPoses out;
  for (const CameraFrame& cf : set.frames) {
    const MapCamera& c = map.camera(cf.camera);
    if (c.frames.empty() || c.frames.back().set != set.id || !c.frames.back().valid()) continue;
    const FramePose& f = c.frames.back();
    PublicPose pose{.agent = c.name, .map = f.map, .capture_ns = f.capture_ns, .cam_from_map = f.cam_from_world};
    const bool known = cf.frame.pose_state == PoseState::kTracked && cf.frame.server_run == server_run;
    if (known) pose.covariance = cf.frame.pose_covariance;
    pose.velocity = velocity_of(c);
    pose.cam_from_odom = odom->follow(c.name, f.capture_ns, f.cam_from_world,
                                      [&](TimeNs capture_ns) { return pose_at(c, f.map, capture_ns); });
    out.cameras.push_back(std::move(pose));
  }
  return out;
}

PublicMoving copy_moving(const Map& map, const std::vector<MovingObject>& objects) {
  PublicMoving out;
  std::map<PointId, ObjectId> object_of;
  for (const MovingObject& o : objects) {
    for (const PointId id : o.members) object_of[id] = o.id;
    out.maps[o.map].objects.push_back({o.id, o.motion.centroid, o.motion.velocity, o.motion.extent});
  }
  for (const MapPoint* p : map.moving_points()) {
    if (p->last_seen != map.now()) continue;
    const auto object = object_of.find(p->id);
    out.maps[p->map].points.push_back(
        {p->position.cast<float>(), sigma_of(*p), p->id, object == object_of.end() ? ObjectId() : object->second});
  }
  return out;
}

PublicTracks copy_tracks(const Map& map, const FrameSet& set) {
  PublicTracks out;
  for (const CameraFrame& cf : set.frames) {
    const MapCamera& c = map.camera(cf.camera);
    PublicImage image{.agent = c.name, .capture_ns = cf.frame.capture_ns, .camera = c.model};
    image.tracks.reserve(cf.frame.tracks.size());
    auto track = c.tracks.begin();  // both ascend
    for (const TrackObservation& seen : cf.frame.tracks) {
      while (track != c.tracks.end() && track->first < seen.track) ++track;
      const bool known = track != c.tracks.end() && track->first == seen.track;
      image.tracks.push_back(
          {seen.track, seen.undistorted_px, known ? state_of(map, track->second) : PublicTrackState::kNone});
    }
    out.cameras.push_back(std::move(image));
  }
  return out;
}

PublicPaths copy_paths(const Map& map) {
  PublicPaths out;
  for (const MapCamera& c : map.cameras()) {
    if (c.map != MapId()) out.cameras.push_back(path_of(map, c));
  }
  return out;
}

void CloudCopy::begin(const Map& map) {
  cloud_ = std::make_shared<PublicCloud>();
  cloud_->points.reserve(map.points().size());
  last_ = PointId();
}

std::shared_ptr<PublicCloud> CloudCopy::go_on(const Map& map, std::size_t most) {
  auto p = map.points().upper_bound(last_);
  for (; p != map.points().end() && most > 0; ++p, --most) {
    last_ = p->first;
    if (p->second.rests()) cloud_->points.push_back(static_point(p->second));
  }
  if (p != map.points().end()) return nullptr;
  return std::exchange(cloud_, nullptr);
}

}  // namespace coslam
