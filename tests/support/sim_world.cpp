// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/sim_world.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace coslam::test {
namespace {

constexpr double kHalfWidth_m = 6, kHalfHeight_m = 2, kNear_m = 3, kFar_m = 9;

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) { return std::uniform_real_distribution<>(low, high)(random); }

// Walls, floor and ceiling, and things in between.
Eigen::Vector3d in_room(Random& random) {
  const Eigen::Vector3d p{uniform(random, -kHalfWidth_m, kHalfWidth_m), uniform(random, -kHalfHeight_m, kHalfHeight_m),
                          uniform(random, kNear_m, kFar_m)};
  const double kind = uniform(random, 0, 1);
  if (kind < 0.35) return {p.x(), p.y(), kFar_m};
  if (kind < 0.45) return {p.x(), p.y() < 0 ? -kHalfHeight_m : kHalfHeight_m, p.z()};
  if (kind < 0.55) return {p.x() < 0 ? -kHalfWidth_m : kHalfWidth_m, p.y(), p.z()};
  return p;
}

Eigen::Vector3d on_plane(Random& random) {
  const double x = uniform(random, -kHalfWidth_m, kHalfWidth_m), y = uniform(random, -3, 3);
  return {x, y, 6 + 0.3 * x - 0.1 * y};
}

Eigen::Vector3d around(Random& random) {
  const double angle = uniform(random, 0, 2 * std::numbers::pi), distance_m = uniform(random, 3, 8);
  return {distance_m * std::sin(angle), distance_m * uniform(random, -0.5, 0.5), distance_m * std::cos(angle)};
}

}  // namespace

SimWorld::SimWorld(const WorldConfig& config) {
  Random random(config.seed);
  Point body;
  for (int i = 0; i < config.points + config.moving_points; ++i) {
    Point& p = points_.emplace_back();
    p.position = config.layout == Layout::kPlane    ? on_plane(random)
                 : config.layout == Layout::kAround ? around(random)
                                                    : in_room(random);
    for (auto& byte : p.descriptor) byte = static_cast<std::uint8_t>(255 * std::pow(uniform(random, 0, 1), 3));
    for (auto& ripple : p.texture) {
      const double frequency = 2 * std::numbers::pi * uniform(random, 0.1, 0.3), angle = uniform(random, 0, 6.28);
      ripple = {frequency * Eigen::Vector2d(std::cos(angle), std::sin(angle)), uniform(random, 0, 6.28)};
    }
    if (i < config.points) continue;
    constexpr int kBodyPoints = 25;
    if ((i - config.points) % kBodyPoints == 0) {
      body.position = {uniform(random, -2, 2), uniform(random, -0.6, 0.6), uniform(random, 4, 6)};
      body.radius_m = uniform(random, 0.3, 0.6);
      body.rate_rad_s = uniform(random, 1.0, 2.0);
      body.phase_rad = uniform(random, 0, 6.28);
    }
    const Eigen::Vector3d offset(uniform(random, -0.25, 0.25), uniform(random, -0.6, 0.6), uniform(random, -0.2, 0.2));
    p.position = body.position + offset;
    p.radius_m = body.radius_m;
    p.rate_rad_s = body.rate_rad_s;
    p.phase_rad = body.phase_rad;
  }
}

Eigen::Vector3d SimWorld::position(int point, TimeNs t_ns) const {
  const Point& p = points_[static_cast<std::size_t>(point)];
  if (p.radius_m == 0) return p.position;
  const double angle = p.phase_rad + p.rate_rad_s * to_seconds(t_ns);
  return p.position + p.radius_m * Eigen::Vector3d(std::cos(angle), 0.3 * std::sin(angle), std::sin(angle));
}

Patch SimWorld::patch(int point, const CameraModel& camera, const Rigid3& cam_from_world, TimeNs t_ns) const {
  constexpr double kPatchScale = 0.3;
  const Point& p = points_[static_cast<std::size_t>(point)];
  const Eigen::Vector3d at = position(point, t_ns);
  Eigen::Matrix<double, 3, 2> tangents;
  tangents.col(0) = Eigen::Vector3d::UnitY().cross(at).normalized();
  tangents.col(1) = at.cross(tangents.col(0)).normalized();
  const Eigen::Matrix<double, 2, 3> px_by_world =
      camera.project_jacobian(cam_from_world * at) * cam_from_world.rotation.toRotationMatrix();
  const double texture_px_per_m = kPatchScale * camera.focal_px() / at.norm();
  const Eigen::Matrix2d texture_by_patch = texture_px_per_m * (px_by_world * tangents).inverse() / kPatchScale;
  Patch out;
  for (int i = 0; i < kPatchBytes; ++i) {
    const Eigen::Vector2d d =
        texture_by_patch * Eigen::Vector2d(i % kPatchSide - kPatchSide / 2, i / kPatchSide - kPatchSide / 2);
    double grey = 128;
    for (const auto& ripple : p.texture) grey += 22 * std::cos(ripple.rad_px.dot(d) + ripple.phase_rad);
    out[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
  }
  return out;
}

Patch SimWorld::patch(int point) const {
  const Eigen::Vector3d at = position(point);
  const Eigen::Quaterniond forward = Eigen::Quaterniond::FromTwoVectors(at, Eigen::Vector3d::UnitZ());
  return patch(point, sim_camera(), Rigid3(forward, Eigen::Vector3d::Zero()));
}

CameraModel sim_camera() {
  CameraModel c;
  c.width_px = 640;
  c.height_px = 480;
  c.fx = c.fy = 417;
  c.cx = 320;
  c.cy = 240;
  return c;
}

Rigid3 looking(const Eigen::Vector3d& center_m, double yaw_rad, double pitch_rad) {
  const Eigen::Quaterniond world_from_cam(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()) *
                                          Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitX()));
  return Rigid3(world_from_cam, center_m).inverse();
}

std::array<Eigen::Vector3d, 4> tag_corners(const Eigen::Vector3d& m, double side_m) {
  const double h = side_m / 2;
  return {m + Eigen::Vector3d(-h, -h, 0), m + Eigen::Vector3d(h, -h, 0), m + Eigen::Vector3d(h, h, 0),
          m + Eigen::Vector3d(-h, h, 0)};
}

CameraPath wave_path(const Wave& wave) {
  return [wave](double t_s) {
    const double a = 2 * std::numbers::pi * t_s / wave.period_s;
    const Eigen::Vector3d shape{std::sin(a), std::sin(2 * a), 1 - std::cos(a)};
    return looking(wave.center_m + wave.amplitude_m.cwiseProduct(shape),
                   wave.yaw_rad + wave.yaw_sweep_rad * std::sin(a), 0.05 * std::sin(a));
  };
}

CameraPath still_path(const Rigid3& cam_from_world) {
  return [cam_from_world](double) { return cam_from_world; };
}

std::vector<CameraPath> paths_side_by_side(int cameras) {
  std::vector<CameraPath> paths;
  for (int i = 0; i < cameras; ++i) {
    const double side = i - 0.5 * (cameras - 1);
    paths.push_back(wave_path({.center_m = {1.2 * side, 0.1 * side, 0},
                               .amplitude_m = {1.0 + 0.1 * i, 0.2, 0.3},
                               .period_s = 6.0 + 0.7 * i,
                               .yaw_rad = -0.08 * side}));
  }
  return paths;
}

}  // namespace coslam::test
