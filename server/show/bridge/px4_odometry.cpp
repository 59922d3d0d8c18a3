// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/bridge/px4_odometry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/geometry/camera_in_world.h"

namespace coslam {
namespace {

constexpr double kOldest_s = 0.2;
constexpr float kNotKnown = std::numeric_limits<float>::quiet_NaN();

// Columns: where the camera's x (right), y (down) and z (ahead) point, forward right down.
Eigen::Matrix3d frd_from_optical() {
  Eigen::Matrix3d r;
  r << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  return r;
}

Rigid3 body_from_camera(const Px4Config& c) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  constexpr double kRad = std::numbers::pi / 180;
  const Eigen::Quaterniond turned = AngleAxisd(kRad * c.yaw_deg, Vector3d::UnitZ()) *
                                    AngleAxisd(kRad * c.pitch_deg, Vector3d::UnitY()) *
                                    AngleAxisd(kRad * c.roll_deg, Vector3d::UnitX());
  return {turned * Eigen::Quaterniond(frd_from_optical()), {c.forward_m, c.right_m, c.down_m}};
}

ros::VehicleOdometry::Vector floats(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

// Variances of the vehicle's place along the axes of the fixed frame, and of its turns about those of its body.
struct Variances {
  Eigen::Vector3d place, turn;
};

Variances variances_of(const TrackFrame& frame, const Rigid3& frd_from_body, const Rigid3& body_from_cam,
                       const Eigen::Quaterniond& frd_from_map) {
  const Matrix6d in_map = camera_covariance_in_world(frame.cam_from_world, frame.pose_covariance.cast<double>());
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = frd_from_map.toRotationMatrix();
  // Turning about the camera moves the vehicle's origin, which is an arm away.
  Matrix6d arm = Matrix6d::Identity();
  arm.topRightCorner<3, 3>() = skew(frd_from_body.rotation * body_from_cam.translation);
  const Matrix6d in_frd = arm * turn * in_map * turn.transpose() * arm.transpose();
  const Eigen::Matrix3d r = frd_from_body.rotation.toRotationMatrix();
  const Eigen::Matrix3d about_body = r.transpose() * in_frd.bottomRightCorner<3, 3>() * r;
  return {in_frd.diagonal().head<3>(), about_body.diagonal()};
}

// By the clock of the agent's machine as it is set now.
TimeNs taken_ns(const TrackFrame& frame) {
  constexpr TimeNs kFarthest_ns = 4'000'000'000'000'000'000;  // the year 2096: sums and differences stay in range
  return std::clamp(frame.capture_ns, -kFarthest_ns, kFarthest_ns) + frame.clock_set_ns;
}

}  // namespace

const char* sentence_of(Px4Refusal refusal) {
  switch (refusal) {
    case Px4Refusal::kLost:
      return "its agent is lost";
    case Px4Refusal::kNotTold:
      return "the map server has not said in which map its pose is";
    case Px4Refusal::kScaleUnknown:
      return "the scale of the map is not known (a baseline, a rig or a printed tag gives it)";
    case Px4Refusal::kTooOld:
      return "its poses are older than 0.2 s by the clock of this machine";
    case Px4Refusal::kAhead:
      return "its stamps are ahead of the clock of this machine";
    case Px4Refusal::kDoubted:
      return "its images are not to be believed";
  }
  return "";
}

Px4Odometry::Px4Odometry(const Px4Config& config, const MapLevel& level)
    : config_(config), body_from_cam_(body_from_camera(config)), frd_from_map_(frd_from_map(level)) {}

void Px4Odometry::see(const AgentPose& pose) {
  if (pose.agent == config_.agent) agent_pose_ = pose;
}

// The server says what an epoch is before or when the agent takes it over.
std::optional<Px4Refusal> Px4Odometry::refusal_of(const TrackFrame& frame, TimeNs now_ns) const {
  if (frame.pose_state != PoseState::kTracked) return Px4Refusal::kLost;
  if (frame.images_doubted) return Px4Refusal::kDoubted;
  const bool is_current = agent_pose_ && agent_pose_->agent_run == frame.agent_run &&
                          agent_pose_->server_run == frame.server_run && agent_pose_->epoch >= frame.epoch;
  if (!is_current) return Px4Refusal::kNotTold;
  if (agent_pose_->state != PoseState::kTracked) return Px4Refusal::kLost;
  if (!agent_pose_->scale_known) return Px4Refusal::kScaleUnknown;
  const double age_s = to_seconds(now_ns - taken_ns(frame));
  if (age_s > kOldest_s) return Px4Refusal::kTooOld;
  if (age_s < -kOldest_s) return Px4Refusal::kAhead;
  return std::nullopt;
}

Px4Odometry::Answer Px4Odometry::on_frame(const TrackFrame& frame, TimeNs now_ns) {
  if (const auto refused = refusal_of(frame, now_ns)) {
    lost_ |= *refused == Px4Refusal::kLost;
    return {std::nullopt, refused};
  }
  const Rigid3 map_from_body = frame.cam_from_world.inverse() * body_from_cam_.inverse();
  const Vehicle now{frame.capture_ns,  // without jumps
                    {(frd_from_map_ * map_from_body.rotation).normalized(), frd_from_map_ * map_from_body.translation}};
  const Variances variances = variances_of(frame, now.frd_from_body, body_from_cam_, frd_from_map_);
  count_jump(now, {frame.agent_run, frame.server_run, agent_pose_->map},
             std::sqrt(std::max(0.0, variances.place.sum())));

  ros::VehicleOdometry out;
  out.timestamp = static_cast<std::uint64_t>(std::max<TimeNs>(now_ns, 0) / 1000);
  out.timestamp_sample = static_cast<std::uint64_t>(std::max<TimeNs>(taken_ns(frame), 0) / 1000);
  out.pose_frame = ros::VehicleOdometry::kFrd;
  out.position = floats(now.frd_from_body.translation);
  const Eigen::Quaternionf q = now.frd_from_body.rotation.cast<float>();
  out.q = {q.w(), q.x(), q.y(), q.z()};
  out.velocity.fill(kNotKnown);
  out.angular_velocity.fill(kNotKnown);
  out.velocity_variance.fill(kNotKnown);
  out.position_variance = floats(variances.place);
  out.orientation_variance = floats(variances.turn);
  if (frame.pose_covariance.isZero()) {
    out.position_variance.fill(kNotKnown);
    out.orientation_variance.fill(kNotKnown);
  }
  out.reset_counter = resets_;
  out.quality = static_cast<std::int8_t>(std::clamp<int>(frame.pose_inliers, 1, 100));
  return {out, std::nullopt};
}

void Px4Odometry::count_jump(const Vehicle& now, const Origin& origin, double sigma_m) {
  if (origin_) {
    const bool jumped = *origin_ != origin || lost_ || !continues(now, sigma_m);
    if (jumped) {
      ++resets_;
      last_.reset();
    }
  }
  origin_ = origin;
  lost_ = false;
  before_last_ = last_;
  last_ = now;
}

// Whether the vehicle could have come here from where it was, as it moved then: no motion does what a correction does.
bool Px4Odometry::continues(const Vehicle& now, double sigma_m) const {
  constexpr double kLongest_s = 0.5, kNoise_m = 0.03, kNoise_rad = 0.03;
  constexpr double kMostMps = 15, kMostRadPerS = 6, kMostMps2 = 30, kMostRadPerS2 = 60;  // of a nimble vehicle
  if (!last_) return true;
  const double dt_s = to_seconds(now.t_ns - last_->t_ns);
  if (dt_s <= 0 || dt_s > kLongest_s) return false;
  Rigid3 expected = last_->frd_from_body;
  double within_m = kMostMps * dt_s, within_rad = kMostRadPerS * dt_s;  // where it had no motion yet
  if (before_last_) {
    const Rigid3 before = before_last_->frd_from_body;
    const double before_s = to_seconds(last_->t_ns - before_last_->t_ns);
    const double ratio = dt_s / before_s;
    expected.translation += ratio * (expected.translation - before.translation);
    expected.rotation = so3_exp(ratio * so3_log(expected.rotation * before.rotation.conjugate())) * expected.rotation;
    within_m = 0.5 * kMostMps2 * dt_s * (dt_s + before_s);
    within_rad = 0.5 * kMostRadPerS2 * dt_s * (dt_s + before_s);
  }
  const double off_m = (now.frd_from_body.translation - expected.translation).norm();
  const double off_rad = so3_log(now.frd_from_body.rotation * expected.rotation.conjugate()).norm();
  return off_m < kNoise_m + 3 * sigma_m + within_m && off_rad < kNoise_rad + within_rad;
}

}  // namespace coslam
