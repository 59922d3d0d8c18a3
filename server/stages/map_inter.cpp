// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/stages/map_inter.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "server/stages/follow.h"
#include "server/stages/patch_match.h"
#include "server/stages/track_grid.h"

namespace coslam {
namespace {

struct Feature {
  ServerTrack* track;
  Eigen::Vector2d px;
};

struct Seed {
  Eigen::Vector2d in_first, disparity;
};

// One pair of cameras at one set.
struct PairView {
  MapCamera* first;
  MapCamera* second;
  Rigid3 first_pose, second_pose;
  Eigen::Matrix3d fundamental;  // line in second = F * (pixel in first)
  std::vector<Seed> seeds;
};

Eigen::Matrix3d intrinsics_inverse(const CameraModel& c) {
  Eigen::Matrix3d k;
  k << 1 / c.fx, 0, -c.cx / c.fx, 0, 1 / c.fy, -c.cy / c.fy, 0, 0, 1;
  return k;
}

std::vector<Seed> shared_points(const Map& map, CameraId first, CameraId second) {
  std::vector<Seed> seeds;
  const MapCamera& other = map.camera(second);
  for (const auto& [id, t] : map.camera(first).tracks) {
    const MapPoint* p = map.find(t.point);
    if (p == nullptr) continue;
    for (const BoundTrack& bound : p->bound) {
      if (bound.camera != second) continue;
      const Eigen::Vector2d here = t.seen.back().undistorted_px.cast<double>(),
                            there = other.tracks.at(bound.track).seen.back().undistorted_px.cast<double>();
      seeds.push_back({here, there - here});
    }
  }
  return seeds;
}

// Of cameras with a pose, at an instant.
PairView make_pair_view(Map& map, const ViewEdge& edge, const Rigid3& first_pose, const Rigid3& second_pose) {
  PairView v{&map.camera(edge.first), &map.camera(edge.second)};
  v.first_pose = first_pose;
  v.second_pose = second_pose;
  const Rigid3 second_from_first = v.second_pose * v.first_pose.inverse();
  const Eigen::Matrix3d essential = skew(second_from_first.translation) * second_from_first.rotation.toRotationMatrix();
  v.fundamental = intrinsics_inverse(v.second->model).transpose() * essential * intrinsics_inverse(v.first->model);
  v.seeds = shared_points(map, edge.first, edge.second);
  return v;
}

std::vector<Feature> unmapped(MapCamera& camera) {
  std::vector<Feature> out;
  for (auto& [id, t] : camera.tracks) {
    if (t.point == PointId() && !t.moving && !t.doubtful && t.patch)
      out.push_back({&t, t.seen.back().undistorted_px.cast<double>()});
  }
  return out;
}

std::optional<Eigen::Vector2d> expected_disparity(const PairView& view, const Eigen::Vector2d& px, double radius_px) {
  const Seed* best = nullptr;
  double least = radius_px * radius_px;
  for (const Seed& s : view.seeds) {
    const double d2 = (s.in_first - px).squaredNorm();
    if (d2 < least) {
      least = d2;
      best = &s;
    }
  }
  return best == nullptr ? std::nullopt : std::optional(best->disparity);
}

struct Score {
  int best = -1;
  double first = -2, second = -2;
  void offer(int index, double value) {
    if (value > first) {
      second = first;
      first = value;
      best = index;
    } else {
      second = std::max(second, value);
    }
  }
};

// Pairs of tracks on each other's epipolar line are scored by how alike they look; best per feature on both sides.
class PairScores {
 public:
  PairScores(const PairView& view, const std::vector<Feature>& a, const std::vector<Feature>& b, double band_px,
             const MapInterConfig& config)
      : of_a(a.size()), of_b(b.size()), view_(view), a_(a), b_(b), band_px_(band_px), config_(config) {
    for (const Feature& f : a) {
      const Eigen::Vector3d line = view.fundamental * f.px.homogeneous();
      lines_.emplace_back(line / std::max(1e-12, line.head<2>().norm()));
      disparities_.push_back(expected_disparity(view, f.px, radius_px()));
    }
  }

  // Those that may join; then, for those that came into question by that, what competes with it.
  void score(auto&& may_join, auto&& alike) {
    for_all([&](std::size_t i, std::size_t j) {
      if (may_join(a_[i], b_[j])) offer(i, j, alike);
    });
    const auto good = [&](const Score& s) { return s.first >= config_.zncc_min; };
    std::vector<bool> row(a_.size()), column(b_.size());
    std::transform(of_a.begin(), of_a.end(), row.begin(), good);
    std::transform(of_b.begin(), of_b.end(), column.begin(), good);
    for_all([&](std::size_t i, std::size_t j) {
      if ((row[i] || column[j]) && !may_join(a_[i], b_[j])) offer(i, j, alike);
    });
  }

  std::vector<Score> of_a, of_b;
  int compared = 0;

 private:
  double radius_px() const {
    return config_.seed_radius * std::max(view_.first->model.width_px, view_.first->model.height_px);
  }
  void for_all(auto&& visit) const {
    for (std::size_t i = 0; i < a_.size(); ++i) {
      for (std::size_t j = 0; j < b_.size(); ++j) visit(i, j);
    }
  }
  void offer(std::size_t i, std::size_t j, auto&& alike) {
    if (std::abs(lines_[i].dot(b_[j].px.homogeneous())) > band_px_) return;
    const auto& disparity = disparities_[i];
    if (disparity && (b_[j].px - a_[i].px - *disparity).norm() > config_.disparity_gate * radius_px()) return;
    ++compared;
    const double s = alike(a_[i], b_[j]);
    of_a[i].offer(static_cast<int>(j), s);
    of_b[j].offer(static_cast<int>(i), s);
  }

  const PairView& view_;
  const std::vector<Feature>&a_, &b_;
  double band_px_;
  const MapInterConfig& config_;
  std::vector<Eigen::Vector3d> lines_;  // in the second image, of unit normals
  std::vector<std::optional<Eigen::Vector2d>> disparities_;
};

bool fits_back(const MapCamera& camera, const ServerTrack& track, const Eigen::Vector3d& position, double most_px,
               int frames) {
  int checked = 0;
  for (std::size_t i = track.seen.size(); i-- > 0 && checked < frames;) {
    if (track.seen[i].set.value < track.distrusted_before) break;
    const FramePose* f = camera.frame_at(track.seen[i].set);
    if (f == nullptr || f->map != camera.map) continue;
    Eigen::Vector2d px;
    if (!project_world(camera.model, f->cam_from_world, position, &px)) return false;
    if ((px - track.seen[i].undistorted_px.cast<double>()).norm() > most_px) return false;
    ++checked;
  }
  return checked > 0;
}

bool try_point(Map& map, const PairView& view, const Feature& a, const Feature& b, const FrameSet& set,
               const MapInterConfig& config) {
  if (!same_centre(*a.track->patch, *b.track->patch)) return false;
  std::vector<View> views = map.views_of(*view.first, *a.track, 6);
  const std::vector<View> other = map.views_of(*view.second, *b.track, 6);
  if (views.empty() || other.empty()) return false;
  views.insert(views.end(), other.begin(), other.end());
  const double sigma_px = std::max(view.first->sigma_px, view.second->sigma_px);
  const TriangulationResult t = triangulate(views, sigma_px, config.min_parallax_rad);
  if (t.status != TriangulationStatus::kOk) return false;
  const double theta = map.config().theta;
  if (!fits_back(*view.first, *a.track, t.position, theta * map.gate_sigma_px(*view.first), config.check_back))
    return false;
  if (!fits_back(*view.second, *b.track, t.position, theta * map.gate_sigma_px(*view.second), config.check_back))
    return false;
  const double distance = (t.position - view.first_pose.center()).norm();
  const Eigen::Matrix3d covariance = map.covariance_of(t.position, {{view.first, a.track}, {view.second, b.track}});
  if (std::sqrt(covariance.trace()) > config.max_relative_sigma * distance) return false;
  MapPoint& p = map.create_point(view.first->map, t.position, covariance, set.id, set.t_ns);
  map.bind(p, view.first->id, *a.track);
  map.bind(p, view.second->id, *b.track);
  return true;
}

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

int best_pairs(const PairView& view, const std::vector<Feature>& a, const std::vector<Feature>& b, double band_px,
               const MapInterConfig& config, auto&& may_join, auto&& alike, MapInterReport* report, auto&& join) {
  PairScores scores(view, a, b, band_px, config);
  scores.score(may_join, alike);
  report->compared += scores.compared;
  int joined = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Score& s = scores.of_a[i];
    if (s.best < 0 || s.first < config.zncc_min || s.first - s.second < config.zncc_margin) continue;
    const Score& back = scores.of_b[static_cast<std::size_t>(s.best)];
    if (back.best != static_cast<int>(i) || back.first - back.second < config.zncc_margin) continue;
    const Feature& other = b[static_cast<std::size_t>(s.best)];
    if (!may_join(a[i], other)) continue;
    ++report->matched;
    joined += join(a[i], other) ? 1 : 0;
  }
  return joined;
}

bool here(const MapCamera& c, const FrameSet& set) {
  return !c.frames.empty() && c.frames.back().set == set.id && c.frames.back().valid();
}

double band_px_of(const Map& map, const PairView& view) {
  return map.gate_sigma_px(*view.first) + map.gate_sigma_px(*view.second);
}

}  // namespace

MapInterReport map_inter(Map& map, const FrameSet& set, const ViewGraph& graph, const MapInterConfig& config) {
  MapInterReport report;
  for (const ViewEdge& edge : graph.tree) {
    if (!here(map.camera(edge.first), set) || !here(map.camera(edge.second), set)) continue;
    const MapCamera &first = map.camera(edge.first), &second = map.camera(edge.second);
    const PairView view =
        make_pair_view(map, edge, first.frames.back().cam_from_world, second.frames.back().cam_from_world);
    report.created += best_pairs(
        view, unmapped(*view.first), unmapped(*view.second), band_px_of(map, view), config,
        [](const Feature&, const Feature&) { return true; },
        [](const Feature& a, const Feature& b) { return zncc(*a.track->patch, *b.track->patch); }, &report,
        [&](const Feature& a, const Feature& b) { return try_point(map, view, a, b, set, config); });
  }
  return report;
}

MapInterReport map_moving(Map& map, const FrameSet& set, const ViewGraph& graph, const MapInterConfig& config) {
  MapInterReport report;
  for (const ViewEdge& edge : graph.edges) {
    if (!here(map.camera(edge.first), set) || !here(map.camera(edge.second), set)) continue;
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
