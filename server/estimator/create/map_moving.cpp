// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/create/map_moving.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "server/estimator/associate/pair_match.h"
#include "server/estimator/associate/patch_match.h"
#include "server/estimator/map/sighting.h"
#include "server/estimator/motion/evidence.h"
#include "server/estimator/motion/follow.h"

namespace coslam {
namespace {

// Tracks of what moves or may move, at the instant of the set: those without a point, and those of moving points that
// the other camera does not see yet.
std::vector<Feature> moving(const Map& map, const MapCamera& camera, CameraId other) {
  std::vector<Feature> out;
  for (const auto& [id, t] : camera.tracks) {
    if (!t.patch) continue;
    const MapPoint* p = map.find(t.point);
    if (p != nullptr && (!p->moves() || seen_by(*p, other))) continue;
    const auto view = view_at(camera, t, t.seen.size() - 1, map.now_ns());
    if (view) out.push_back({&t, view->undistorted_px - t.offset_px.cast<double>()});
  }
  return out;
}

// Where the two tracks, each with its offset, are one place now; empty when they are not.
std::optional<TriangulationResult> meeting_now(const Map& map, const PairView& view, const ServerTrack& a,
                                               const ServerTrack& b) {
  const TimeNs t_ns = view.first->taken_ns(view.first->frames.back());
  const auto va = view_at(*view.first, a, a.seen.size() - 1, t_ns),
             vb = view_at(*view.second, b, b.seen.size() - 1, t_ns);
  if (!va || !vb) return std::nullopt;
  return position_of(map, {{{view.first->id, a.id}, *va}, {{view.second->id, b.id}, *vb}},
                     map.config().min_parallax_rad);
}

// Not far in depth from the moving points beside it in the image, if there are any: texture repeats along epipolar
// lines, and things are compact.
bool beside_in_depth(const Map& map, const PairView& view, const Eigen::Vector3d& position) {
  Eigen::Vector2d px;
  if (!project_world(view.first->model, view.first_pose, position, &px)) return false;
  const double depth = (view.first_pose * position).z(), radius_px = kOneThing * view.first->model.width_px;
  int alike = 0, other_count = 0;
  for (const MapPoint* p : map.moving_points()) {
    if (p->map != view.first->map || p->last_seen.value + 2 < map.now().value) continue;
    Eigen::Vector2d other_px;
    if (!project_world(view.first->model, view.first_pose, p->position, &other_px)) continue;
    if ((other_px - px).norm() > radius_px) continue;
    (std::abs((view.first_pose * p->position).z() - depth) < kOneThing * depth ? alike : other_count) += 1;
  }
  return alike >= other_count;
}

// How the patches of two tracks match if the two are one place; the shift is in pixels of the second image.
std::optional<PatchPeak> peak_if_one(const PairView& view, const Feature& a, const Feature& b) {
  const auto seen = [](const MapCamera& c, const Rigid3& pose, const Feature& f) {
    return View{&c.model, pose, f.px + f.track->offset_px.cast<double>()};
  };
  const std::array<View, 2> views{seen(*view.first, view.first_pose, a), seen(*view.second, view.second_pose, b)};
  const TriangulationResult place = triangulate(views, view.first->sigma_px, 0);
  if (place.status != TriangulationStatus::kOk) return std::nullopt;
  const auto alike = made_alike({view.first, view.first_pose, &*a.track->patch},
                                {view.second, view.second_pose, &*b.track->patch}, place.position);
  auto peak = alike ? peak_in(alike->first, alike->second) : std::nullopt;
  if (peak) peak->shift_px = alike->second_by_view * peak->shift_px;
  return peak;
}

// Where two matched tracks, each with its offset, are one thing that moves; empty when they are not.
std::optional<TriangulationResult> one_mover(const Map& map, const PairView& view, const Feature& a, const Feature& b,
                                             const MapMovingConfig& config) {
  const auto now = meeting_now(map, view, *a.track, *b.track);
  if (!now || !(a.track->moves() || b.track->moves()) || !beside_in_depth(map, view, now->position))
    return std::nullopt;
  return moved_as_one(map, view, a, b, config.check_back_s) ? now : std::nullopt;
}

bool fuse_movers(MapMovingEdit& edit, const MapPoint& p, const MapPoint& q) {
  if (seen_at_once(p, q)) return false;
  edit.fuse(p.id, q.id, Why::kOneMover);
  return true;
}

// What two matched tracks of moving things become: a new point, a further track of one, or two points made one.
bool join_moving(MapMovingEdit& edit, const PairView& view, const Feature& a, const Feature& b,
                 const MapMovingConfig& config) {
  const Map& map = edit.map();
  const MapPoint *p = map.find(a.track->point), *q = map.find(b.track->point);
  const auto peak = peak_if_one(view, a, b);
  if (!peak) return false;
  if (p != nullptr && q != nullptr) return one_mover(map, view, a, b, config) && fuse_movers(edit, *p, *q);
  // The free one of the two is brought to where the other one's point is.
  const bool free_b = q == nullptr;
  const Eigen::Vector2f shift = peak->shift_px.cast<float>();
  ServerTrack shifted = free_b ? *b.track : *a.track;
  shifted.offset_px = free_b ? Eigen::Vector2f(a.track->offset_px + shift) : b.track->offset_px - shift;
  const Feature in_a = free_b ? a : Feature{&shifted, a.px}, in_b = free_b ? Feature{&shifted, b.px} : b;
  const auto now = one_mover(map, view, in_a, in_b, config);
  if (!now) return false;
  const MapPoint* point = free_b ? p : q;
  const bool is_new = point == nullptr;
  if (is_new) {
    const double distance = (now->position - view.first_pose.center()).norm();
    point = &edit.create_point(view.first->map, now->position, now->covariance, PointPhase::kMoving,
                               Why::kMetWhileMoving, {2, std::sqrt(now->covariance.trace()) / distance});
    edit.bind_moving(*point, view.first->id, *a.track, Eigen::Vector2f::Zero(), Why::kMadeFromIt);
  }
  const Feature& free = free_b ? b : a;
  edit.bind_moving(*point, (free_b ? view.second : view.first)->id, *free.track, shifted.offset_px, Why::kLooksLikeIt,
                   {peak->zncc, 0});
  // Its path begins when its two tracks first met, not when that was found out.
  if (is_new) record_past(edit, *point, a.track->seen.size());
  return true;
}

}  // namespace

MapMovingReport map_moving(MapMovingEdit& edit, const FrameSet& set, const ViewGraph& graph,
                           const PairMatchConfig& match, const MapMovingConfig& config) {
  const Map& map = edit.map();
  MapMovingReport report;
  for (const ViewEdge& edge : graph.edges) {
    if (!has_pose_now(map.camera(edge.first), set) || !has_pose_now(map.camera(edge.second), set)) continue;
    const auto first_pose = map.camera(edge.first).pose_at(set.id, set.t_ns),
               second_pose = map.camera(edge.second).pose_at(set.id, set.t_ns);
    const std::vector<Feature> first = moving(map, map.camera(edge.first), edge.second),
                               second = moving(map, map.camera(edge.second), edge.first);
    // Of two that become one point, at least one is seen to move.
    const auto moves = [](const Feature& f) { return f.track->moves(); };
    if (std::none_of(first.begin(), first.end(), moves) && std::none_of(second.begin(), second.end(), moves)) continue;
    const PairView view = make_pair_view(map, edge, *first_pose, *second_pose);
    const auto either_moves = [](const Feature& a, const Feature& b) { return a.track->moves() || b.track->moves(); };
    const auto as_one = [&](const Feature& a, const Feature& b) {
      const auto peak = peak_if_one(view, a, b);
      return peak ? peak->zncc : -1;
    };
    report.joined += best_pairs(
        map, view, first, second, band_px_of(map, view) + kMostShift_px, match, either_moves, as_one, &report.pairs,
        [&](const Feature& a, const Feature& b) { return join_moving(edit, view, a, b, config); });
  }
  return report;
}

}  // namespace coslam
