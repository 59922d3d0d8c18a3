// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/stages/map_intra.h"

#include <algorithm>
#include <cmath>

namespace coslam {
namespace {

constexpr std::uint32_t kRetrySets = 4;

// Cheap bound before anything is solved: angle between the rays of the first and the newest view.
double ray_angle(const std::vector<View>& views) {
  const double c = world_ray(views.front()).dot(world_ray(views.back()));
  return std::acos(std::clamp(c, -1.0, 1.0));
}

bool gate_in_every_view(const std::vector<View>& views, const TriangulationResult& t, double gate_px, double theta) {
  for (const View& v : views) {
    Eigen::Vector2d px;
    if (!project_world(*v.camera, v.cam_from_world, t.position, &px)) return false;
    if ((px - v.undistorted_px).squaredNorm() > theta * theta * gate_px * gate_px) return false;
  }
  return true;
}

}  // namespace

MapIntraReport map_intra(Map& map, const FrameSet& set, const MapIntraConfig& config) {
  MapIntraReport report;
  for (const CameraFrame& cf : set.frames) {
    MapCamera& camera = map.camera(cf.camera);
    if (!camera.frames.back().valid()) continue;
    const Eigen::Vector3d center = camera.frames.back().cam_from_world.center();
    for (auto& [id, track] : camera.tracks) {
      if (track.point != PointId() || set.id.value < track.mapping_after) continue;
      if (track.moving || track.doubtful) continue;
      // A track that left a point before may do so because it moves: it has to prove itself for longer.
      const int least = track.distrusted_before > 0 ? config.min_track_frames : config.early_track_frames;
      if (static_cast<int>(track.seen.size()) < least) continue;
      const std::vector<View> all = map.views_of(camera, track, 1000);
      if (static_cast<int>(all.size()) < least) continue;
      track.mapping_after = set.id.value + kRetrySets;
      const bool mature = static_cast<int>(all.size()) >= config.min_track_frames;
      const double parallax = mature ? config.min_parallax_rad : config.early_parallax_rad;
      if (ray_angle(all) < parallax) continue;
      ++report.tried;
      const TriangulationResult t = triangulate(map.views_of(camera, track, 12), camera.sigma_px, parallax);
      if (t.status != TriangulationStatus::kOk) continue;
      if (!gate_in_every_view(all, t, map.gate_sigma_px(camera), map.config().theta)) continue;
      const Eigen::Matrix3d covariance = map.covariance_of(t.position, {{&camera, &track}});
      if (std::sqrt(covariance.trace()) > config.max_relative_sigma * (t.position - center).norm()) continue;
      MapPoint& p = map.create_point(camera.map, t.position, covariance, set.id, set.t_ns);
      p.proven = mature;
      map.bind(p, camera.id, track);
      ++report.created;
    }
  }
  return report;
}

}  // namespace coslam
