// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/follow.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "server/estimator/motion/evidence.h"

namespace coslam {
namespace {

// One of more than two observations is wrong: which one, if without it the others agree.
std::optional<std::size_t> odd_one_out(const Map& map, const std::vector<Seen>& seen) {
  if (seen.size() < 3) return std::nullopt;
  std::optional<std::size_t> odd;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    std::vector<Seen> rest = seen;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
    if (!position_of(map, rest, kLeastParallax_rad)) continue;
    if (odd) return std::nullopt;
    odd = i;
  }
  return odd;
}

struct Step {
  Eigen::Vector3d from, to;
};

// Of a neighbour: those within a fifth of the radius count alike.
double weight_at(double distance2, double radius) { return 1 / (distance2 + 0.04 * radius * radius); }

// How moving points near this place moved since the last set.
std::optional<Eigen::Vector3d> step_near(const std::vector<Step>& steps, const Eigen::Vector3d& place, double radius) {
  double weights = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Step& s : steps) {
    const double distance2 = (s.from - place).squaredNorm();
    if (distance2 > radius * radius) continue;
    const double weight = weight_at(distance2, radius);
    weights += weight;
    sum += weight * (s.to - s.from);
  }
  return weights > 0 ? std::optional<Eigen::Vector3d>(sum / weights) : std::nullopt;
}

// Motion in the image since the last set, near a place in it, of the tracks that move.
std::optional<Eigen::Vector2d> flow_near(const MapCamera& camera, const Eigen::Vector2d& before_px) {
  const double radius_px = kNeighbours * camera.model.width_px;
  double weights = 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const auto& [id, t] : camera.tracks) {
    const std::size_t n = t.seen.size();
    if (!t.moves() || n < 2 || t.seen[n - 2].set.value + 1 != t.seen[n - 1].set.value) continue;
    const double distance2 = (t.seen[n - 2].undistorted_px.cast<double>() - before_px).squaredNorm();
    if (distance2 > radius_px * radius_px) continue;
    const double weight = weight_at(distance2, radius_px);
    weights += weight;
    sum += weight * (t.seen[n - 1].undistorted_px - t.seen[n - 2].undistorted_px).cast<double>();
  }
  return weights > 0 ? std::optional<Eigen::Vector2d>(sum / weights) : std::nullopt;
}

// Where each camera would see the point now if it went with what moves beside it in the image.
std::vector<View> views_by_flow(const Map& map, const MapPoint& p) {
  std::vector<View> views;
  for (const MapCamera& c : map.cameras()) {
    if (c.map != p.map || c.frames.size() < 2 || c.frames.back().set != map.now()) continue;
    const FramePose &now = c.frames.back(), &before = c.frames[c.frames.size() - 2];
    Eigen::Vector2d before_px;
    if (now.map != p.map || before.map != p.map ||
        !project_world(c.model, before.cam_from_world, p.position, &before_px))
      continue;
    if (const auto flow_px = flow_near(c, before_px))
      views.push_back({&c.model, now.cam_from_world, before_px + *flow_px});
  }
  return views;
}

struct Loose {
  const MapPoint* point;
  std::vector<Seen> seen;
};

double distance_to_cameras(const Map& map, const MapPoint& p) {
  double least = 1e9;
  for (const MapCamera& c : map.cameras()) {
    if (c.map != p.map || c.frames.empty() || !c.frames.back().valid()) continue;
    least = std::min(least, (c.frames.back().cam_from_world.center() - p.position).norm());
  }
  return least;
}

void refresh_patches(ClassifyEdit& edit, const MapPoint& p, const FrameSet& set) {
  for (const BoundTrack& b : p.bound) {
    const ServerTrack& t = edit.map().track(b);
    if (t.patch_set == set.id) edit.give_patch(p, b.camera, t);
  }
  edit.keep_newest_patches(p, 2 * kPatchesOfPoint);
}

// By what its cameras see now; without the one view that is wrong, if there is one.
std::optional<TriangulationResult> position_now(ClassifyEdit& edit, const MapPoint& p, std::vector<Seen>* seen,
                                                FollowReport* report) {
  const Map& map = edit.map();
  *seen = seen_now(map, p);
  if (auto t = position_of(map, *seen, kLeastParallax_rad)) return t;
  const auto odd = odd_one_out(map, *seen);
  if (!odd) return std::nullopt;
  const BoundTrack b = (*seen)[*odd].track;
  edit.unbind(b.camera, map.track(b), Why::kOddOneOut, {static_cast<double>(seen->size()) - 1, 0});
  ++report->unbound;
  *seen = seen_now(map, p);
  return position_of(map, *seen, kLeastParallax_rad);
}

void record(ClassifyEdit& edit, const MapPoint& p, const std::vector<Seen>& seen, const FrameSet& set) {
  MotionSample sample{.set = set.id, .t_ns = set.t_ns};
  for (const Seen& s : seen) {
    const ServerTrack& track = edit.map().track(s.track);
    edit.pass_gate(track);
    sample.seen.push_back(sighting(edit.map().camera(s.track.camera), track, track.seen.size() - 1));
  }
  edit.record_motion(p.id, std::move(sample));
}

// Positions from two cameras, this instant.
void position_all(ClassifyEdit& edit, const FrameSet& set, FollowReport* report, std::vector<Step>* steps,
                  std::vector<Loose>* loose) {
  for (const MapPoint* moving : edit.map().moving_points()) {
    const MapPoint& p = *moving;
    std::vector<Seen> seen;
    const auto t = position_now(edit, p, &seen, report);
    if (!t) {
      loose->push_back({&p, std::move(seen)});
      continue;
    }
    if (p.last_seen.value + 1 == set.id.value) steps->push_back({p.position, t->position});
    edit.follow(p, t->position, t->covariance);
    record(edit, p, seen, set);
    refresh_patches(edit, p, set);
    ++report->positioned;
  }
}

// The tracks that do not lead to where the point was carried; the one nearest to it stays.
void let_go_of_strays(ClassifyEdit& edit, Loose& loose, double most_px, FollowReport* report) {
  std::vector<std::pair<double, std::size_t>> miss_px;
  for (std::size_t i = 0; i < loose.seen.size(); ++i) {
    const View& v = loose.seen[i].view;
    Eigen::Vector2d px;
    const bool seen = project_world(*v.camera, v.cam_from_world, loose.point->position, &px);
    miss_px.emplace_back(seen ? (px - v.undistorted_px).norm() : 1e9, i);
  }
  std::sort(miss_px.begin(), miss_px.end());
  for (std::size_t k = miss_px.size(); k-- > 0;) {
    if (k == 0 && miss_px[k].first <= most_px) break;
    const BoundTrack b = loose.seen[miss_px[k].second].track;
    edit.unbind(b.camera, edit.map().track(b), Why::kStray, {miss_px[k].first, 0});
    ++report->unbound;
  }
  std::erase_if(loose.seen, [&](const Seen& s) { return edit.map().track(s.track).point != loose.point->id; });
}

// The place moved sideways onto the ray of its one view, at the depth that it has.
Eigen::Vector3d kept_to_ray(const Eigen::Vector3d& position, const View& v) {
  const Eigen::Vector3d center = v.cam_from_world.center(), ray = world_ray(v);
  return center + ray * std::max(1e-6, (position - center).dot(ray));
}

// Its step since the last set: as its moving neighbours in space or, without any, in the images.
std::optional<Eigen::Vector3d> step_of(const Map& map, const MapPoint& p, const std::vector<Step>& steps,
                                       double radius) {
  if (auto step = step_near(steps, p.position, radius)) return step;
  const std::vector<View> views = views_by_flow(map, p);
  if (views.empty()) return std::nullopt;
  Eigen::Vector3d moved;
  if (views.size() == 1) {
    moved = kept_to_ray(p.position, views.front());
  } else {
    const TriangulationResult t = triangulate(views, 1.0, kLeastParallax_rad);
    if (t.status != TriangulationStatus::kOk) return std::nullopt;
    moved = t.position;
  }
  const Eigen::Vector3d step = moved - p.position;
  return step.norm() < radius ? std::optional(step) : std::nullopt;
}

void carry(ClassifyEdit& edit, const FrameSet& set, const std::vector<Step>& steps, Loose& loose,
           const FollowConfig& config, FollowReport* report) {
  const Map& map = edit.map();
  const MapPoint& p = *loose.point;
  const std::uint32_t unseen_sets = set.id.value - p.last_seen.value;
  const double radius = config.neighbour_radius * distance_to_cameras(map, p);
  const auto step = step_of(map, p, steps, radius);
  const std::uint32_t limit = map.sets_in(step || !loose.seen.empty() ? config.forget_s : config.forget_alone_s);
  if (unseen_sets > limit) {
    edit.remove_point(p, Why::kOutOfSight, {static_cast<double>(unseen_sets), static_cast<double>(limit)});
    ++report->removed;
    return;
  }
  ++report->carried;
  const Eigen::Vector3d move = step.value_or(Eigen::Vector3d::Zero());
  // Neighbours move alike to a fifth or so; without any the radius bounds where it may have gone in a while.
  const double drift = step ? 0.2 * move.norm() : 0.05 * radius;
  edit.move_point(p, p.position + move, p.covariance + drift * drift * Eigen::Matrix3d::Identity());
  if (cameras_of(loose.seen) >= 2) let_go_of_strays(edit, loose, 2 * gate_px_of(map, loose.seen), report);
  if (loose.seen.size() == 1) edit.move_point(p, kept_to_ray(p.position, loose.seen.front().view), p.covariance);
}

}  // namespace

FollowReport follow_moving(ClassifyEdit& edit, const FrameSet& set, const FollowConfig& config) {
  FollowReport report;
  std::vector<Step> steps;
  std::vector<Loose> loose;
  position_all(edit, set, &report, &steps, &loose);
  for (Loose& l : loose) carry(edit, set, steps, l, config, &report);
  return report;
}

void record_past(MovingPathEdit& edit, const MapPoint& point, std::size_t most_sets) {
  const Map& map = edit.map();
  const MapCamera& dated_by = map.camera(point.bound.front().camera);
  const ServerTrack& first = map.track(point.bound.front());
  std::vector<MotionSample> past;
  for (std::size_t i = first.seen.size() - 1; i-- > 0 && past.size() < most_sets;) {
    const FramePose* f = dated_by.frame_at(first.seen[i].set);
    if (f == nullptr) break;
    MotionSample sample{.set = f->set, .t_ns = dated_by.taken_ns(*f)};
    std::vector<Seen> seen;
    for (const BoundTrack& b : point.bound) {
      const ServerTrack& track = map.track(b);
      const auto at = track.index_at(f->set);
      const auto view = at ? view_at(map.camera(b.camera), track, *at, sample.t_ns) : std::nullopt;
      if (!view) continue;
      seen.push_back({b, *view});
      sample.seen.push_back(sighting(map.camera(b.camera), track, *at));
    }
    if (!position_of(map, seen, kLeastParallax_rad)) break;
    past.push_back(std::move(sample));
  }
  for (auto s = past.rbegin(); s != past.rend(); ++s) edit.record_motion(point.id, std::move(*s));
}

}  // namespace coslam
