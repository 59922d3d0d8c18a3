// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/create/map_inter.h"

#include <algorithm>
#include <cmath>

#include "server/estimator/associate/pair_match.h"
#include "server/estimator/associate/patch_match.h"
#include "server/estimator/associate/verify.h"
#include "server/estimator/map/sighting.h"

namespace coslam {
namespace {

std::vector<Feature> unmapped(const MapCamera& camera) {
  std::vector<Feature> out;
  for (const auto& [id, t] : camera.tracks) {
    if (t.free_and_resting() && t.patch) out.push_back({&t, t.seen.back().undistorted_px.cast<double>()});
  }
  return out;
}

bool try_point(MapInterEdit& edit, const PairView& view, const Feature& a, const Feature& b) {
  const Map& map = edit.map();
  if (!same_centre(*a.track->patch, *b.track->patch)) return false;
  std::vector<View> views = map.views_of(*view.first, *a.track, kViewsOfTrack);
  const std::vector<View> other = map.views_of(*view.second, *b.track, kViewsOfTrack);
  if (views.empty() || other.empty()) return false;
  views.insert(views.end(), other.begin(), other.end());
  const double sigma_px = std::max(view.first->sigma_px, view.second->sigma_px);
  const TriangulationResult t = triangulate(views, sigma_px, map.config().min_parallax_rad);
  if (t.status != TriangulationStatus::kOk) return false;
  const PointEstimate place{t.position, Eigen::Matrix3d::Zero()};
  if (!explains_past(map, *view.first, *a.track, place) || !explains_past(map, *view.second, *b.track, place))
    return false;
  const Eigen::Matrix3d covariance = map.covariance_of(t.position, {{view.first, a.track}, {view.second, b.track}});
  const double sigma = std::sqrt(covariance.trace()), distance = (t.position - view.first_pose.center()).norm();
  const MapPoint& p = edit.create_point(view.first->map, t.position, covariance, PointPhase::kStatic,
                                        Why::kTwoCamerasNow, {2, sigma / distance});
  edit.bind(p, view.first->id, *a.track, Why::kMadeFromIt);
  edit.bind(p, view.second->id, *b.track, Why::kMadeFromIt);
  return true;
}

}  // namespace

MapInterReport map_inter(MapInterEdit& edit, const FrameSet& set, const ViewGraph& graph,
                         const MapInterConfig& config) {
  const Map& map = edit.map();
  MapInterReport report;
  for (const ViewEdge& edge : graph.tree) {
    if (!has_pose_now(map.camera(edge.first), set) || !has_pose_now(map.camera(edge.second), set)) continue;
    const MapCamera &first = map.camera(edge.first), &second = map.camera(edge.second);
    const PairView view =
        make_pair_view(map, edge, first.frames.back().cam_from_world, second.frames.back().cam_from_world);
    report.created += best_pairs(
        map, view, unmapped(*view.first), unmapped(*view.second), band_px_of(map, view), config.match,
        [](const Feature&, const Feature&) { return true; },
        [](const Feature& a, const Feature& b) { return zncc(*a.track->patch, *b.track->patch); }, &report.pairs,
        [&](const Feature& a, const Feature& b) { return try_point(edit, view, a, b); });
  }
  return report;
}

}  // namespace coslam
