// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/pose/wide_search.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "common/geometry/pose_refinement.h"
#include "server/estimator/associate/patch_match.h"
#include "server/estimator/associate/points_by_place.h"
#include "server/estimator/associate/track_grid.h"

namespace coslam {
namespace {

struct Match {
  const MapPoint* point;
  const ServerTrack* track;
  double zncc;
};

// Of the tracks around it the one that looks like it, when no other does.
std::optional<Match> match_of(const Map& map, const MapCamera& camera, const MapPoint& point, const TrackGrid& grid,
                              double radius_px) {
  Eigen::Vector2d px;
  if (!project_world(camera.model, camera.frames.back().cam_from_world, point.position, &px)) return std::nullopt;
  Match best{&point, nullptr, map.config().zncc_min};
  double second = -1;
  grid.near(px, radius_px, [&](const TrackGrid::InGrid& in) {
    if ((in.px - px).norm() > radius_px) return;
    const ServerTrack* t = in.track;
    const FramePose* cut_at = camera.frame_at(t->patch_set);
    if (cut_at == nullptr || cut_at->map != point.map) return;
    const auto fit = fit_patch(map, point, camera, cut_at->cam_from_world, *t->patch);
    if (!fit) return;
    if (fit->zncc > best.zncc && fit->same_centre) {
      if (best.track != nullptr) second = std::max(second, best.zncc);
      best = {&point, t, fit->zncc};
    } else {
      second = std::max(second, fit->zncc);
    }
  });
  if (best.track == nullptr || best.zncc < second + map.config().zncc_margin) return std::nullopt;
  return best;
}

std::vector<const MapPoint*> proven_points(const Map& map, double back_s) {
  std::vector<const MapPoint*> out = map.points_seen_since(map.set_ago(back_s));
  std::erase_if(out, [](const MapPoint* p) { return !p->proven(); });
  return out;
}

std::vector<Match> matches_of(const Map& map, const MapCamera& camera, const PointsByPlace& points,
                              const WideSearchConfig& config) {
  const TrackGrid grid(camera, [](const ServerTrack& t) { return t.free_and_resting() && t.patch; });
  const double radius_px = config.search_rad * camera.model.focal_px();
  std::map<TrackId, Match> best;  // a track shows one point
  for (const MapPoint* p : points.near_tracks(camera, grid, {.least_px = radius_px, .most_px = radius_px})) {
    if (seen_by(*p, camera.id)) continue;
    const auto match = match_of(map, camera, *p, grid, radius_px);
    if (!match) continue;
    const auto [at, added] = best.try_emplace(match->track->id, *match);
    if (!added && at->second.zncc < match->zncc) at->second = *match;
  }
  std::vector<Match> out;
  out.reserve(best.size());
  for (const auto& [id, match] : best) out.push_back(match);
  return out;
}

}  // namespace

WideSearchReport wide_search(WideSearchEdit& edit, const FrameSet& set, const WideSearchConfig& config, int least) {
  WideSearchReport report;
  const Map& map = edit.map();
  std::optional<PointsByPlace> points;
  for (const CameraFrame& cf : set.frames) {
    const MapCamera& camera = map.camera(cf.camera);
    if (!camera.sparse || !camera.frames.back().valid() || map.is_posed_by_rig(camera)) continue;
    if (!points) points.emplace(proven_points(map, config.memory_s));
    const std::vector<Match> matches = matches_of(map, camera, *points, config);
    if (static_cast<int>(matches.size()) < least) continue;
    std::vector<PointObservation> observations;
    observations.reserve(matches.size() + camera.tracks.size());
    for (const Match& m : matches) {
      observations.push_back(
          {m.point->position, m.point->covariance, m.track->seen.back().undistorted_px.cast<double>()});
    }
    for (const auto& [id, t] : camera.tracks) {
      const MapPoint* p = map.find(t.point);
      if (p != nullptr && p->proven())
        observations.push_back({p->position, p->covariance, t.seen.back().undistorted_px.cast<double>()});
    }
    const PoseResult r = refine_pose(camera.model, observations, camera.frames.back().cam_from_world,
                                     {.sigma_px = map.sigma_bound_px(camera), .max_iterations = 30});
    if (r.status != PoseStatus::kOk) continue;
    const auto agree =
        std::count(r.is_inlier.begin(), r.is_inlier.begin() + static_cast<std::ptrdiff_t>(matches.size()), true);
    if (agree < least || 2 * agree < std::ssize(matches)) continue;
    edit.set_pose(camera, set.id, r.cam_from_world);
    edit.push_pose_to_agent(camera);
    ++report.cameras;
    for (std::size_t i = 0; i < matches.size(); ++i) {
      if (!r.is_inlier[i] || seen_by(*matches[i].point, camera.id)) continue;
      edit.bind(*matches[i].point, camera.id, *matches[i].track, Why::kRegistered, {0, matches[i].zncc});
      edit.keep_recent(*matches[i].point);
      ++report.points;
    }
  }
  return report;
}

}  // namespace coslam
