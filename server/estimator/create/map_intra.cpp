// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/create/map_intra.h"

#include <algorithm>
#include <cmath>

#include "server/estimator/associate/verify.h"

namespace coslam {
namespace {

// Poses that rest on hardly any known points may be off by some share of the turn between them: less parallax may be
// theirs alone.
constexpr double kOfTurn = 0.25;

// Cheap bound before anything is solved: angle between the rays of the first and the newest view.
double ray_angle(const std::vector<View>& views) {
  const double c = world_ray(views.front()).dot(world_ray(views.back()));
  return std::acos(std::clamp(c, -1.0, 1.0));
}

double turn_rad(const std::vector<View>& views) {
  return views.front().cam_from_world.rotation.angularDistance(views.back().cam_from_world.rotation);
}

// The track becomes a point, when its views determine one.
bool try_track(MapIntraEdit& edit, const MapCamera& camera, const ServerTrack& track, const MapIntraConfig& config,
               bool in_window, MapIntraReport* report) {
  const Map& map = edit.map();
  // A track that left a point before may do so because it moves: it has to prove itself for longer.
  const int long_enough = camera.frames_in(map.config().check_back_s, camera.least_views());
  const int least =
      track.distrusted_before > 0 ? long_enough : camera.frames_in(config.early_track_s, camera.least_views());
  if (static_cast<int>(track.seen.size()) < least) return false;
  const std::vector<View> all = map.views_of(camera, track, 1000);
  if (static_cast<int>(all.size()) < least) return false;
  edit.map_not_before(track, SetId(map.now().value + map.sets_in(map.config().match_period_s)));
  const bool mature = static_cast<int>(all.size()) >= long_enough;
  double parallax = mature ? map.config().min_parallax_rad : config.early_parallax_rad;
  if (in_window && !mature) parallax = std::max(parallax, kOfTurn * turn_rad(all));
  if (ray_angle(all) < parallax) return false;
  ++report->tried;
  const TriangulationResult t = triangulate(map.views_of(camera, track, 12), camera.sigma_px, parallax);
  if (t.status != TriangulationStatus::kOk) return false;
  const PointEstimate point{t.position, Eigen::Matrix3d::Zero()};
  if (!explains(point, all, map.gate_sigma_px(camera), map.config().theta)) return false;
  const Eigen::Matrix3d covariance = map.covariance_of(t.position, {{&camera, &track}});
  const double sigma = std::sqrt(covariance.trace()),
               distance = (t.position - camera.frames.back().cam_from_world.center()).norm();
  const MapPoint& p =
      edit.create_point(camera.map, t.position, covariance, mature ? PointPhase::kStatic : PointPhase::kTrial,
                        Why::kOneCamerasMotion, {static_cast<double>(all.size()), sigma / distance});
  edit.bind(p, camera.id, track, Why::kMadeFromIt);
  return true;
}

}  // namespace

MapIntraReport map_intra(MapIntraEdit& edit, const FrameSet& set, const WindowPoseReport& windows,
                         const MapIntraConfig& config) {
  MapIntraReport report;
  for (const CameraFrame& cf : set.frames) {
    const MapCamera& camera = edit.map().camera(cf.camera);
    if (!camera.frames.back().valid()) continue;
    for (const auto& [id, track] : camera.tracks) {
      if (!track.free_and_resting() || set.id.value < track.mapping_after) continue;
      report.created += try_track(edit, camera, track, config, windows.has(camera.id), &report) ? 1 : 0;
    }
  }
  return report;
}

}  // namespace coslam
