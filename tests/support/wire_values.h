// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <type_traits>

#include "common/model/agent_images.h"
#include "common/model/agent_pose.h"
#include "common/model/map_patch.h"
#include "common/model/moving_state.h"
#include "common/model/public_sample.h"
#include "common/model/session.h"
#include "common/model/thumbnail.h"
#include "common/model/track_frame.h"

// Random but valid values of everything that crosses the wire, for tests of the codec and the links.
namespace coslam::test {

inline CameraModel vga_camera() {
  CameraModel camera;
  camera.width_px = 640;
  camera.height_px = 480;
  camera.fx = 525.25;
  camera.fy = 524.75;
  camera.cx = 319.5;
  camera.cy = 239.5;
  camera.distortion = DistortionModel::kRadTan;
  camera.coefficients = {-0.28, 0.07, 1e-4, -2e-4};
  return camera;
}

class WireValues {
 public:
  explicit WireValues(std::uint64_t seed) : random_(seed) {}

  // A small message of any type, with something in all that it may hold, of agent "cam0" and run 1.
  template <class Value>
  Value sample() {
    return sample(std::type_identity<Value>());
  }

  double uniform(double low, double high) { return std::uniform_real_distribution<>(low, high)(random_); }
  std::uint32_t below(std::uint32_t bound) {
    return std::uniform_int_distribution<std::uint32_t>(0, bound - 1)(random_);
  }

  Eigen::Vector2f grid_px(double scale) { return quantised_px({uniform(-100, 740), uniform(-100, 580)}, scale); }
  Rigid3 pose() {
    const Vector6d d = Vector6d::NullaryExpr([this] { return uniform(-2, 2); });
    return retract({}, d);
  }
  // As the wire carries it, to the bit.
  Eigen::Matrix<float, 6, 1> point_covariance() {
    Eigen::Matrix3d l = Eigen::Matrix3d::Zero();
    for (int row = 0; row < 3; ++row) {
      for (int col = 0; col < row; ++col) l(row, col) = Eigen::half(static_cast<float>(uniform(-0.1, 0.1)));
      l(row, row) = Eigen::half(static_cast<float>(uniform(0.1, 0.3)));
    }
    return pack_covariance(l * l.transpose());
  }
  PoseCovariance pose_covariance() {
    const Matrix6d a = Matrix6d::NullaryExpr([this] { return uniform(-1e-2, 1e-2); });
    return quantised_pose_covariance(a * a.transpose());
  }

  Hello hello(const std::string& agent, RunId run, Pacing pacing = Pacing::kLockstep) {
    return {agent, run, kProtocolVersion, pacing, 29.97, vga_camera()};
  }

  TrackFrame frame(const std::string& agent, RunId run, std::uint32_t number, int tracks = 300) {
    TrackFrame f;
    f.agent = agent;
    f.agent_run = run;
    f.frame = FrameId(number);
    f.capture_ns = 1'700'000'000'000'000'000 + 33'333'333LL * number;
    f.pose_state = PoseState::kTracked;
    f.server_run = RunId(77);
    f.epoch = MapEpoch(below(100));
    f.cam_from_world = pose();
    f.pose_covariance = pose_covariance();
    f.pose_inliers = static_cast<std::uint16_t>(tracks / 2);
    f.hull_fraction = static_cast<float>(uniform(0, 1));
    f.applied_patch = number;
    std::uint32_t id = 1 + below(100000);
    for (int i = 0; i < tracks; ++i) {
      f.tracks.push_back({TrackId(id), grid_px(pixel_scale(vga_camera()))});
      id += 1 + (below(10) == 0 ? below(500) : below(8));
    }
    for (std::uint32_t i = 0; i < number % 3; ++i) f.tags.push_back(tag(static_cast<std::uint16_t>(40 * i)));
    return f;
  }

  TagObservation tag(std::uint16_t id) {
    TagObservation t{TagId(id), {}};
    for (auto& px : t.undistorted_px) px = grid_px(pixel_scale(vga_camera()));
    return t;
  }

  PatchReply patches(const TrackFrame& frame, int count) {
    PatchReply reply{frame.agent, frame.agent_run, frame.frame, {}};
    for (int i = 0; i < count; ++i) {
      ImagePatch& patch = reply.patches.emplace_back();
      patch.track = TrackId(1 + below(1000000));
      for (auto& grey : patch.grey) grey = static_cast<std::uint8_t>(below(256));
      patch.grey = quantised_patch(patch.grey);
    }
    return reply;
  }

  DescriptorReply descriptors(const TrackFrame& frame, int count) {
    DescriptorReply reply{frame.agent, frame.agent_run, frame.frame, {}, {}};
    for (int i = 0; i < count; ++i) reply.tracks.emplace_back(static_cast<std::uint32_t>(3 * i + 1));
    for (int i = 0; i < count * kDescriptorBytes; ++i) {
      reply.descriptors.push_back(quantised_descriptor(static_cast<std::uint8_t>(below(256))));
    }
    return reply;
  }

  AgentStatus agent_status(const std::string& agent, RunId run, AgentState state = AgentState::kRunning) {
    AgentStatus s{agent, run, state, PoseState::kTracked, below(1000), below(10), 5, ImageFault::kCutOff, 300, 8.5f,
                  {},    {},  {}};
    if (state != AgentState::kFinished) return s;
    s.report_json = R"({"tracked_percent":99.5})";
    s.last_image = descriptors(frame(agent, run, 17), 100);
    return s;
  }

  MapPatch map_patch(const std::string& agent, RunId run, std::uint32_t sequence, int points = 100) {
    MapPatch p;
    p.agent = agent;
    p.agent_run = run;
    p.server_run = RunId(77);
    p.sequence = sequence;
    p.after_frame = FrameId(sequence);
    p.epoch = MapEpoch(3);
    p.group = GroupId(1);
    p.scale_known = true;
    for (int i = 0; i < points; ++i) p.updated.push_back(point());
    for (int i = 0; i < points / 10; ++i) p.unbound.emplace_back(1 + below(1000));
    for (int i = 0; i < points / 10; ++i) p.patch_requests.emplace_back(1 + below(1000));
    return p;
  }

  BoundPoint point() {
    BoundPoint b;
    b.track = TrackId(1 + below(1000000));
    b.point = PointId(1 + below(1000000));
    b.state = static_cast<PointState>(below(3));
    if (b.state == PointState::kUncertain && below(2) == 0) b.point = PointId();  // a direction
    if (!b.has_place()) return b;
    for (float& v : b.position) v = static_cast<float>(uniform(-50, 50));
    b.covariance = point_covariance();
    return b;
  }

  Eigen::Vector3f vector(float low, float high) {
    return Eigen::Vector3f::NullaryExpr([&] { return static_cast<float>(uniform(low, high)); });
  }
  MovingState moving_state(std::size_t objects = 3, std::size_t points = 20) {
    MovingState s{RunId(77), MapId(2), MapEpoch(5), 1'700'000'000'000'000'000, true, below(9), {}, {}};
    for (std::size_t i = 0; i < objects; ++i) {
      s.objects.push_back({ObjectId(1 + below(1000)), vector(-50, 50), vector(-3, 3), vector(0, 2),
                           static_cast<std::uint16_t>(below(100))});
    }
    for (std::size_t i = 0; i < points; ++i) {
      MovingPointState& p = s.points.emplace_back();
      p.point = PointId(1 + below(1000000));
      p.object = ObjectId(below(3));
      p.position = vector(-50, 50);
      for (float& v : p.covariance) v = static_cast<float>(uniform(0, 0.1));
      p.cameras = static_cast<std::uint8_t>(2 + below(5));
    }
    return s;
  }

  AgentPose agent_pose(const std::string& agent, RunId run) {
    AgentPose p{agent, run, RunId(77), 1'700'000'000'000'000'000, MapId(2), MapEpoch(5), PoseState::kTracked, true, {}};
    p.map_from_cam = pose();
    for (float& v : p.covariance.reshaped()) v = static_cast<float>(uniform(0, 0.1));
    return p;
  }

  AgentImages agent_images(const std::string& agent, RunId run) {
    AgentImages a{agent, run, RunId(77), {}, true, "300 of 300 images of " + agent + " came too late"};
    for (std::uint64_t& n : a.images.images) n = below(1000);
    return a;
  }

  Thumbnail thumbnail(const std::string& agent, RunId run) {
    Thumbnail t{agent, run, 1'700'000'000'000'000'000, {0xFF, 0xD8}};
    for (int i = 0; i < 100; ++i) t.jpeg.push_back(static_cast<std::uint8_t>(below(256)));
    t.jpeg.insert(t.jpeg.end(), {0xFF, 0xD9});
    return t;
  }

  PublicSample public_sample() {
    PublicSample s{"/coslam/map/points", "sensor_msgs/msg/PointCloud2", 1'700'000'000'000'000'000, {}};
    for (int i = 0; i < 100; ++i) s.octets.push_back(static_cast<std::uint8_t>(below(256)));
    return s;
  }

  ServerStatus server_status(RunId run) {
    ServerStatus s;
    s.server_run = run;
    s.started = true;
    s.start_utc_ns = 1'700'000'000'000'000'000;
    s.frame_sets = below(1000);
    s.points = below(10000);
    s.agents = {"cam0", "cam1"};
    return s;
  }

 private:
  Hello sample(std::type_identity<Hello>) { return hello("cam0", RunId(1)); }
  TrackFrame sample(std::type_identity<TrackFrame>) { return frame("cam0", RunId(1), 5, 40); }
  PatchReply sample(std::type_identity<PatchReply>) { return patches(sample<TrackFrame>(), 3); }
  DescriptorReply sample(std::type_identity<DescriptorReply>) { return descriptors(sample<TrackFrame>(), 3); }
  AgentStatus sample(std::type_identity<AgentStatus>) {
    AgentStatus s = agent_status("cam0", RunId(1), AgentState::kFinished);
    s.exchange = {1'700'000'000'000'000'000, 1'700'000'000'010'000'000, 1'700'000'000'500'000'000};
    s.last_image = descriptors(sample<TrackFrame>(), 20);
    return s;
  }
  MapPatch sample(std::type_identity<MapPatch>) {
    MapPatch p = map_patch("cam0", RunId(1), 5, 10);
    p.new_from_old.scale = 2;
    p.continues = ContinuedMap{RunId(76), MapEpoch(2)};
    p.placed = PlacedPose{FrameId(4), pose()};
    p.lens.emplace().values << 0.03125, -4.5, 2.25, 0, 0.001953125, 0, -0.015625, 0.5, 0, 0, 0, 0.25;
    p.sent_ns = 1'700'000'000'000'000'000;
    p.uplink_wait_s = 0.25F;
    return p;
  }
  MovingState sample(std::type_identity<MovingState>) { return moving_state(); }
  AgentPose sample(std::type_identity<AgentPose>) { return agent_pose("cam0", RunId(1)); }
  AgentImages sample(std::type_identity<AgentImages>) { return agent_images("cam0", RunId(1)); }
  ThumbnailRequest sample(std::type_identity<ThumbnailRequest>) { return {"cam0", RunId(1), RunId(77)}; }
  Thumbnail sample(std::type_identity<Thumbnail>) { return thumbnail("cam0", RunId(1)); }
  PublicSample sample(std::type_identity<PublicSample>) { return public_sample(); }
  ServerStatus sample(std::type_identity<ServerStatus>) {
    ServerStatus s = server_status(RunId(77));
    s.refused = {{RunId(2), "no"}};
    return s;
  }

  std::mt19937_64 random_;
};

}  // namespace coslam::test
