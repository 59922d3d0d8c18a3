// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/verify.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace coslam {

std::optional<double> gate_distance2(const PointEstimate& point, const CameraModel& camera,
                                     const Rigid3& cam_from_world, const Eigen::Vector2d& undistorted_px,
                                     double sigma_px) {
  Eigen::Vector2d px;
  Eigen::Matrix<double, 2, 3> j;
  if (!project_world(camera, cam_from_world, point.position, &px, &j)) return std::nullopt;
  const Eigen::Matrix2d raw = camera.raw_by_undistorted(undistorted_px);
  const Eigen::Matrix<double, 2, 3> rj = raw * j;
  const Eigen::Matrix2d s = rj * point.covariance * rj.transpose() + sigma_px * sigma_px * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d r = raw * (undistorted_px - px);
  return r.dot(s.inverse() * r);
}

bool explains(const PointEstimate& point, const std::vector<View>& past, double sigma_px, double theta) {
  return !past.empty() && std::ranges::all_of(past, [&](const View& v) {
    const auto d2 = gate_distance2(point, *v.camera, v.cam_from_world, v.undistorted_px, sigma_px);
    return d2 && *d2 <= theta * theta;
  });
}

bool explains_past(const Map& map, const MapCamera& camera, const ServerTrack& track, const PointEstimate& point) {
  const auto most = static_cast<std::size_t>(camera.frames_in(map.config().check_back_s));
  return explains(point, newest_views(camera, track, most, Past::kTrusted), map.gate_sigma_px(camera),
                  map.config().theta);
}

std::vector<View> newest_views(const MapCamera& camera, const ServerTrack& track, std::size_t most, Past past) {
  std::vector<View> views;
  for (std::size_t i = track.seen.size(); i-- > 0 && views.size() < most;) {
    if (past == Past::kTrusted && track.seen[i].set.value < track.distrusted_before) break;
    const FramePose* f = camera.frame_at(track.seen[i].set);
    if (f == nullptr || f->map != camera.map) continue;
    views.push_back({&camera.model, f->cam_from_world, track.seen[i].undistorted_px.cast<double>()});
  }
  return views;
}

PointEstimate kalman_update(const MapPoint& point, const CameraModel& camera, const Rigid3& cam_from_world,
                            const Eigen::Vector2d& undistorted_px, double sigma_px) {
  Eigen::Vector2d px;
  Eigen::Matrix<double, 2, 3> j;
  if (!project_world(camera, cam_from_world, point.position, &px, &j)) return {point.position, point.covariance};
  const Eigen::Matrix2d raw = camera.raw_by_undistorted(undistorted_px);
  j = (raw * j).eval();
  const Eigen::Matrix2d noise = sigma_px * sigma_px * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d s = j * point.covariance * j.transpose() + noise;
  const Eigen::Matrix<double, 3, 2> gain = point.covariance * j.transpose() * s.inverse();
  const Eigen::Matrix3d keep = Eigen::Matrix3d::Identity() - gain * j;
  PointEstimate now{point.position, point.covariance};
  now.position += gain * (raw * (undistorted_px - px));
  now.covariance = keep * now.covariance * keep.transpose() + gain * noise * gain.transpose();
  return now;
}

namespace {

// True when the camera looks at the point from a new enough direction; remembers it then.
bool turned(VerifyEdit& edit, const MapPoint& point, const MapCamera& camera, double angle_rad) {
  const auto& rays = point.updated_from;
  const bool first = rays.size() <= camera.id.value || rays[camera.id.value].squaredNorm() == 0;
  const Eigen::Vector3d ray = (point.position - camera.frames.back().cam_from_world.center()).normalized();
  if (!first && rays[camera.id.value].dot(ray) > std::cos(angle_rad)) return false;
  edit.note_ray(point, camera.id, ray);
  return !first;
}

// Several cameras see sooner that a point moves than one, whose own motion may explain it.
bool stood_still(const MapPoint& p, const CameraFrames& camera, const VerifyConfig& config) {
  const auto tracks = static_cast<std::uint32_t>(p.bound.size());
  const auto frames = static_cast<std::uint32_t>(camera.frames_in(config.prove_s, 4));
  return p.views >= (tracks > 1 ? tracks * frames / 2 : frames);
}

void pass(VerifyEdit& edit, const FrameSet& set, const MapCamera& camera, const ServerTrack& track,
          const MapPoint& point, const VerifyConfig& config, VerifyReport* report) {
  ++report->inside;
  edit.pass_gate(track);
  edit.see(point);
  if (stood_still(point, camera, config)) edit.prove(point);
  if (track.patch_set == set.id) edit.give_patch(point, camera.id, track);
  if (!point.proven() || !turned(edit, point, camera, edit.map().config().new_view_rad)) return;
  const PointEstimate now =
      kalman_update(point, camera.model, camera.frames.back().cam_from_world,
                    track.seen.back().undistorted_px.cast<double>(), edit.map().covariance_sigma_px(camera));
  edit.move_point(point, now.position, now.covariance);
  ++report->updated;
}

}  // namespace

VerifyReport verify(VerifyEdit& edit, const FrameSet& set, const VerifyConfig& config) {
  VerifyReport report;
  const Map& map = edit.map();
  const double theta2 = map.config().theta * map.config().theta;
  for (const CameraFrame& cf : set.frames) {
    const MapCamera& camera = map.camera(cf.camera);
    const FramePose& frame = camera.frames.back();
    if (!frame.valid()) continue;
    const double gate_px = map.gate_sigma_px(camera);
    int proven = 0;
    for (const auto& [id, track] : camera.tracks) {
      const MapPoint* point = map.find(track.point);
      if (point == nullptr || !point->rests()) continue;
      const Eigen::Vector2d px = track.seen.back().undistorted_px.cast<double>();
      const auto d2 =
          gate_distance2({point->position, point->covariance}, camera.model, frame.cam_from_world, px, gate_px);
      if (d2 && *d2 <= theta2) {
        pass(edit, set, camera, track, *point, config, &report);
        proven += point->proven();
      } else {
        edit.miss_gate(camera.id, track, d2 ? std::sqrt(*d2) : std::nan(""));
        ++report.outside;
      }
    }
    // Where images are seldom, most points have left the view before they are proven.
    edit.set_sparse(camera, proven < map.config().few_points || camera.seldom());
  }
  return report;
}

}  // namespace coslam
