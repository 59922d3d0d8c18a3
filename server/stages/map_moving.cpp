// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/stages/map_moving.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "server/stages/follow.h"
#include "server/stages/pair_match.h"
#include "server/stages/patch_match.h"
#include "server/stages/track_grid.h"

namespace coslam {
namespace {

// Tracks of what moves or may move, at the instant of the set: those without a point, and those of moving points that
// the other camera does not see yet.
std::vector<Feature> moving(const Map& map, MapCamera& camera, CameraId other) {
  std::vector<Feature> out;
  for (auto& [id, t] : camera.tracks) {
    if (!t.patch) continue;
    const MapPoint* p = map.find(t.point);
    if (p != nullptr && (p->state != PointState::kDynamic || seen_by(*p, other))) continue;
    const auto view = view_at(camera, t, t.seen.size() - 1, map.now_ns());
    if (view) out.push_back({&t, view->undistorted_px - t.offset_px.cast<double>()});
  }
  return out;
}

// Where the two tracks were one place, at the instant of the first one's i-th observation; empty when they were not.
std::optional<TriangulationResult> meeting(const Map& map, const PairView& view, const ServerTrack& a, std::size_t i,
                                           const ServerTrack& b, std::size_t j, double min_parallax_rad) {
  const FramePose* f = view.first->frame_at(a.seen[i].set);
  if (f == nullptr) return std::nullopt;
  const TimeNs t_ns = view.first->taken_ns(*f);
  const auto va = view_at(*view.first, a, i, t_ns), vb = view_at(*view.second, b, j, t_ns);
  if (!va || !vb) return std::nullopt;
  return position_of(map, {{{view.first->id, a.id}, *va}, {{view.second->id, b.id}, *vb}}, min_parallax_rad);
}

// The two tracks were one place at every instant that both saw, as far back as asked: what a mismatch along the
// epipolar line does not keep up while the thing moves. Where that was at the first of them.
std::optional<Eigen::Vector3d> together_back(const Map& map, const PairView& view, const ServerTrack& a,
                                             const ServerTrack& b, int least, int most) {
  int checked = 0;
  std::optional<Eigen::Vector3d> oldest;
  for (std::size_t i = a.seen.size(); i-- > 0 && checked < most;) {
    const SetId at = a.seen[i].set;
    const auto other = std::lower_bound(b.seen.begin(), b.seen.end(), at,
                                        [](const TrackPoint& s, SetId want) { return s.set < want; });
    if (other == b.seen.end() || other->set != at) continue;
    if (!view.first->frame_at(at)->valid() || !view.second->frame_at(at)->valid()) continue;
    const auto met = meeting(map, view, a, i, b, static_cast<std::size_t>(other - b.seen.begin()), 0);
    if (!met) return std::nullopt;
    oldest = met->position;
    ++checked;
  }
  return checked >= least ? oldest : std::nullopt;
}

// The camera's track is no longer at what its thing left.
bool left(const Map& map, const MapCamera& camera, const Rigid3& cam_from_world, const Feature& f,
          const Eigen::Vector3d& place) {
  Eigen::Vector2d px;
  if (!project_world(camera.model, cam_from_world, place, &px)) return true;
  return (f.px + f.track->offset_px.cast<double>() - px).norm() > map.config().theta * map.gate_sigma_px(camera);
}

// The path of a new moving point begins when its two tracks first met, not when that was found out.
void record_past(Map& map, const PairView& view, PointId point, const ServerTrack& a, const ServerTrack& b) {
  std::vector<MotionSample> past;
  for (std::size_t i = a.seen.size() - 1, j = b.seen.size() - 1; i-- > 0 && j-- > 0;) {
    if (a.seen[i].set != b.seen[j].set || !meeting(map, view, a, i, b, j, kMovingParallax_rad)) break;
    const TimeNs t_ns = view.first->taken_ns(*view.first->frame_at(a.seen[i].set));
    past.push_back({a.seen[i].set, t_ns, {sighting(*view.first, a, i), sighting(*view.second, b, j)}});
  }
  for (auto s = past.rbegin(); s != past.rend(); ++s) map.record_motion(point, std::move(*s));
}

// Not far in depth from the moving points beside it in the image, if there are any: texture repeats along epipolar
// lines, and things are compact.
bool beside_in_depth(const Map& map, const PairView& view, const Eigen::Vector3d& position) {
  constexpr double kBeside = 0.12;     // of the image width
  constexpr double kMostDepth = 0.12;  // of the depth
  Eigen::Vector2d px;
  if (!project_world(view.first->model, view.first_pose, position, &px)) return false;
  const double depth = (view.first_pose * position).z(), radius_px = kBeside * view.first->model.width_px;
  int alike = 0, others = 0;
  for (const MapPoint* p : map.moving_points()) {
    if (p->map != view.first->map || p->last_seen.value + 2 < map.now().value) continue;
    Eigen::Vector2d other_px;
    if (!project_world(view.first->model, view.first_pose, p->position, &other_px)) continue;
    if ((other_px - px).norm() > radius_px) continue;
    (std::abs((view.first_pose * p->position).z() - depth) < kMostDepth * depth ? alike : others) += 1;
  }
  return alike >= others;
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

// What two matched tracks of moving things become: a new point, a further track of one, or two points made one.
bool join_moving(Map& map, const PairView& view, const Feature& a, const Feature& b, const FrameSet& set,
                 const MapInterConfig& config) {
  MapPoint *p = map.find(a.track->point), *q = map.find(b.track->point);
  const auto peak = peak_if_one(view, a, b);
  if (!peak) return false;
  // The free one of the two is brought to where the other one's point is.
  const bool free_b = q == nullptr;
  ServerTrack& free = free_b ? *b.track : *a.track;
  const Eigen::Vector2f shift = peak->shift_px.cast<float>();
  const Eigen::Vector2f offset_px = free_b ? Eigen::Vector2f(a.track->offset_px + shift) : b.track->offset_px - shift;
  if (p == nullptr || q == nullptr) free.offset_px = offset_px;
  const auto now = meeting(map, view, *a.track, a.track->seen.size() - 1, *b.track, b.track->seen.size() - 1,
                           config.min_parallax_rad);
  const double distance = now ? (now->position - view.first_pose.center()).norm() : 0;
  bool joined = now && (a.track->moving || b.track->moving) &&
                std::sqrt(now->covariance.trace()) <= config.max_relative_sigma * distance &&
                beside_in_depth(map, view, now->position);
  if (joined) {
    const auto before =
        together_back(map, view, *a.track, *b.track, config.moving_check_back / 2, config.moving_check_back);
    // What one camera sees to move, another may take for a thing at rest, nearer or farther away.
    joined =
        before && ((a.track->moving && b.track->moving) || (left(map, *view.first, view.first_pose, a, *before) &&
                                                            left(map, *view.second, view.second_pose, b, *before)));
  }
  if (p == nullptr || q == nullptr) free.offset_px.setZero();
  if (!joined) return false;
  if (p != nullptr && q != nullptr) {
    for (const BoundTrack& bound : p->bound) {
      if (seen_by(*q, bound.camera)) return false;
    }
    map.fuse(p->id, q->id);
    return true;
  }
  if (p == nullptr) std::swap(p, q);
  if (p == nullptr) {
    p = &map.create_point(view.first->map, now->position, now->covariance, set.id, set.t_ns);
    map.set_state(*p, PointState::kDynamic);
    bind_moving(map, *p, view.first->id, *a.track, Eigen::Vector2f::Zero());
    free.offset_px = offset_px;
    record_past(map, view, p->id, *a.track, *b.track);
  }
  bind_moving(map, *p, (free_b ? view.second : view.first)->id, free, offset_px);
  return true;
}

}  // namespace

MapInterReport map_moving(Map& map, const FrameSet& set, const ViewGraph& graph, const MapInterConfig& config) {
  MapInterReport report;
  for (const ViewEdge& edge : graph.edges) {
    if (!has_pose_now(map.camera(edge.first), set) || !has_pose_now(map.camera(edge.second), set)) continue;
    const auto first_pose = map.camera(edge.first).pose_at(set.id, set.t_ns),
               second_pose = map.camera(edge.second).pose_at(set.id, set.t_ns);
    const std::vector<Feature> first = moving(map, map.camera(edge.first), edge.second),
                               second = moving(map, map.camera(edge.second), edge.first);
    // Of two that become one point, at least one is seen to move.
    const auto moves = [](const Feature& f) { return f.track->moving; };
    if (std::none_of(first.begin(), first.end(), moves) && std::none_of(second.begin(), second.end(), moves)) continue;
    const PairView view = make_pair_view(map, edge, *first_pose, *second_pose);
    const auto either_moves = [](const Feature& a, const Feature& b) { return a.track->moving || b.track->moving; };
    const auto as_one = [&](const Feature& a, const Feature& b) {
      const auto peak = peak_if_one(view, a, b);
      return peak ? peak->zncc : -1;
    };
    report.moving +=
        best_pairs(view, first, second, band_px_of(map, view) + kMostShift_px, config, either_moves, as_one, &report,
                   [&](const Feature& a, const Feature& b) { return join_moving(map, view, a, b, set, config); });
  }
  return report;
}

}  // namespace coslam
