// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/stages/verify.h"

#include <Eigen/LU>
#include <algorithm>

namespace coslam {

std::optional<double> gate_distance2(const MapPoint& point, const CameraModel& camera, const Rigid3& cam_from_world,
                                     const Eigen::Vector2d& undistorted_px, double sigma_px) {
  Eigen::Vector2d px;
  Eigen::Matrix<double, 2, 3> j;
  if (!project_world(camera, cam_from_world, point.position, &px, &j)) return std::nullopt;
  const Eigen::Matrix2d s = j * point.covariance * j.transpose() + sigma_px * sigma_px * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d r = undistorted_px - px;
  return r.dot(s.inverse() * r);
}

void kalman_update(MapPoint& point, const CameraModel& camera, const Rigid3& cam_from_world,
                   const Eigen::Vector2d& undistorted_px, double sigma_px) {
  Eigen::Vector2d px;
  Eigen::Matrix<double, 2, 3> j;
  if (!project_world(camera, cam_from_world, point.position, &px, &j)) return;
  const Eigen::Matrix2d noise = sigma_px * sigma_px * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d s = j * point.covariance * j.transpose() + noise;
  const Eigen::Matrix<double, 3, 2> gain = point.covariance * j.transpose() * s.inverse();
  point.position += gain * (undistorted_px - px);
  const Eigen::Matrix3d keep = Eigen::Matrix3d::Identity() - gain * j;
  point.covariance = keep * point.covariance * keep.transpose() + gain * noise * gain.transpose();
}

namespace {

// True when the camera looks at the point from a new enough direction; remembers it then.
bool turned(MapPoint& point, const MapCamera& camera, const Rigid3& pose, double angle_rad) {
  if (point.updated_from.size() <= camera.id.value) {
    point.updated_from.resize(camera.id.value + std::size_t{1}, Eigen::Vector3d::Zero());
  }
  Eigen::Vector3d& last = point.updated_from[camera.id.value];
  const Eigen::Vector3d ray = (point.position - pose.center()).normalized();
  if (last.squaredNorm() > 0 && last.dot(ray) > std::cos(angle_rad)) return false;
  const bool first = last.squaredNorm() == 0;
  last = ray;
  return !first;
}

// Several cameras see sooner that a point moves than one, whose own motion may explain it.
bool stood_still(const MapPoint& p, const VerifyConfig& config) {
  const auto tracks = static_cast<std::uint32_t>(p.bound.size());
  const auto frames = static_cast<std::uint32_t>(config.prove_views);
  return p.views >= (tracks > 1 ? tracks * frames / 2 : frames);
}

bool elsewhere_for_others(const Map& map, const MapPoint& point, CameraId camera) {
  return std::any_of(point.bound.begin(), point.bound.end(), [&](const BoundTrack& b) {
    return b.camera != camera && map.camera(b.camera).tracks.at(b.track).gate_failures > 0;
  });
}

}  // namespace

VerifyReport verify(Map& map, const FrameSet& set, const VerifyConfig& config) {
  VerifyReport report;
  const double theta2 = map.config().theta * map.config().theta;
  for (const CameraFrame& cf : set.frames) {
    MapCamera& camera = map.camera(cf.camera);
    const FramePose& frame = camera.frames.back();
    if (!frame.valid()) continue;
    const double gate_px = map.gate_sigma_px(camera);
    int proven = 0;
    for (auto& [id, track] : camera.tracks) {
      MapPoint* point = map.find(track.point);
      if (point == nullptr || point->state != PointState::kStatic) continue;
      const Eigen::Vector2d px = track.seen.back().undistorted_px.cast<double>();
      const auto d2 = gate_distance2(*point, camera.model, frame.cam_from_world, px, gate_px);
      if (d2 && *d2 <= theta2) {
        ++report.inside;
        track.gate_failures = 0;
        ++point->views;
        point->proven |= stood_still(*point, config);
        point->last_seen = set.id;
        point->last_ns = set.t_ns;
        if (track.patch_set == set.id) map.give_patch(*point, camera.id, track);
        proven += point->proven;
        if (!point->proven) continue;
        if (turned(*point, camera, frame.cam_from_world, config.update_turn_rad)) {
          kalman_update(*point, camera.model, frame.cam_from_world, px, map.covariance_sigma_px(camera));
          ++report.updated;
        }
        continue;
      }
      ++report.outside;
      if (++track.gate_failures < config.failures) continue;
      if (config.leave_moved && elsewhere_for_others(map, *point, camera.id)) continue;
      track.distrusted_before = set.id.value;
      map.unbind(camera.id, track);
      ++report.unbound;
    }
    camera.sparse = proven < config.sparse_points;
  }
  return report;
}

}  // namespace coslam
