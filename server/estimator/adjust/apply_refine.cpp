// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/apply_refine.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <unordered_map>
#include <unordered_set>

#include "server/estimator/adjust/certainty.h"
#include "server/estimator/adjust/lens.h"
#include "server/estimator/adjust/zoom.h"
#include "server/estimator/associate/register.h"

namespace coslam {
namespace {

// How one camera's world changes at its key frames: old_from_new on the right of cam_from_world.
struct Change {
  SetId set;
  Rigid3 old_from_new;
};

Rigid3 carried(const FramePose& frame, const std::vector<Change>& changes) {
  const auto after =
      std::lower_bound(changes.begin(), changes.end(), frame.set, [](const Change& c, SetId s) { return c.set < s; });
  if (after == changes.end()) return frame.cam_from_world * changes.back().old_from_new;
  Rigid3 by_after = frame.cam_from_world * after->old_from_new;
  if (after == changes.begin() || after->set == frame.set) return by_after;
  const Change& before = *(after - 1);
  const double s = static_cast<double>(frame.set.value - before.set.value) / (after->set.value - before.set.value);
  return interpolate(frame.cam_from_world * before.old_from_new, by_after, s);
}

// All relative poses of neighbours in time change equally little between two key frames: the closed form of the soft
// constraints (14) along one camera's path with its key frames fixed.
void carry_frames(BundleEdit& edit, const MapCamera& camera, const RefineJob& job, const std::vector<Change>& changes) {
  if (changes.empty()) return;
  const auto first = std::lower_bound(camera.frames.begin(), camera.frames.end(), changes.front().set,
                                      [](const FramePose& f, SetId set) { return f.set < set; });
  bool any = false;
  for (auto f = first; f != camera.frames.end(); ++f) {
    if (f->map != job.map) continue;
    any = true;
    edit.adjust_pose(camera, *f, carried(*f, changes));
  }
  if (!any || camera.map != job.map) return;
  const Rigid3 new_from_old = changes.back().old_from_new.inverse();
  edit.carry_agent(camera, {1.0, new_from_old.rotation, new_from_old.translation});
}

bool moves(const RefineJob& job, std::size_t pose) { return !job.problem.poses[pose].fixed || job.floating; }

// Poses that enough points held while they were solved for. Others go with the frames before and after them.
std::vector<bool> seen_enough(const RefineJob& job) {
  std::vector<int> seen(job.poses.size());
  for (const auto& o : job.problem.observations) ++seen[static_cast<std::size_t>(o.pose)];
  std::vector<bool> out;
  out.reserve(seen.size());
  for (const int n : seen) out.push_back(n >= kLeastPointsOfPose);
  return out;
}

// The key frames that move come first, ascending: what is before stays, however old the poses are that hold them.
SetId first_that_moves(const RefineJob& job) { return job.poses.front().set; }

void move_frames(BundleEdit& edit, const RefineJob& job, const BundleResult& result) {
  const Map& map = edit.map();
  std::vector<std::vector<Change>> changes(map.cameras().size());
  const std::vector<bool> held = seen_enough(job);
  for (std::size_t i = 0; i < job.poses.size(); ++i) {
    if (!moves(job, i) || !held[i]) continue;
    const Rigid3& before = job.problem.poses[i].cam_from_world;
    changes[job.poses[i].camera.value].push_back({job.poses[i].set, before.inverse() * result.poses[i]});
  }
  // Frames between the newest key frame that stays and the first that moves lead from the one to the other.
  const SetId first = first_that_moves(job);
  const auto& keys = map.key_frames();
  const auto at = std::lower_bound(keys.begin(), keys.end(), KeyFrame{first},
                                   [](const KeyFrame& a, const KeyFrame& b) { return a.set < b.set; });
  for (const MapCamera& c : map.cameras()) {
    auto& list = changes[c.id.value];
    if (!list.empty() && at != keys.begin() && at != keys.end()) list.push_back({std::prev(at)->set, Rigid3()});
    std::sort(list.begin(), list.end(), [](const Change& a, const Change& b) { return a.set < b.set; });
    carry_frames(edit, c, job, list);
  }
}

void drop_outliers(BundleEdit& edit, const RefineJob& job, const BundleResult& result, RefineReport* report) {
  for (std::size_t i = 0; i < job.observations.size(); ++i) {
    if (result.is_inlier[i]) continue;
    ++report->outliers;
    const auto& o = job.problem.observations[i];
    const MapPoint* p = edit.map().find(job.points[static_cast<std::size_t>(o.point)]);
    if (p == nullptr) continue;
    edit.drop_observation(*p, job.observations[i].set, job.poses[static_cast<std::size_t>(o.pose)].camera,
                          job.observations[i].track);
  }
}

// From where it was last seen.
double distance_of(const Map& map, const MapPoint& p) {
  const KeyObservation& last = p.key_observations.back();
  const FramePose* f = map.camera(last.camera).frame_at(last.set);
  return f == nullptr ? 0 : (p.position - f->cam_from_world.center()).norm();
}

// Takes its solution; one that is not known to better than its distance goes.
void move_point(BundleEdit& edit, const MapPoint& p, const PointEstimate& to) {
  const Map& map = edit.map();
  if (p.key_observations.size() < 2) {
    edit.remove_point(p, Why::kTooFewViews, {static_cast<double>(p.key_observations.size()), 0});
    return;
  }
  edit.move_point(p, to.position, to.covariance);
  const double sigma = std::sqrt(p.covariance.trace()), distance = distance_of(map, p);
  if (!(sigma < distance)) edit.remove_point(p, Why::kUndetermined, {sigma, distance});
}

// What is to become of a point, if anything.
struct PointMove {
  const MapPoint* point = nullptr;
  std::optional<Eigen::Vector3d> solution;  // else it is triangulated anew
  std::optional<PointEstimate> to;
};

std::vector<PointMove> points_to_move(const Map& map, const RefineJob& job, const BundleResult& result) {
  const std::unordered_set<PointId> solved(job.points.begin(), job.points.end());
  // One that was found to move meanwhile is where its cameras see it now.
  const auto may_move = [&](const MapPoint& p) { return p.map == job.map && p.rests(); };
  std::vector<PointMove> out;
  for (const MapPoint* p : map.points_seen_since(first_that_moves(job))) {
    if (may_move(*p) && !solved.contains(p->id)) out.push_back({p, {}, {}});
  }
  for (std::size_t i = 0; i < job.points.size(); ++i) {
    const MapPoint* p = map.find(job.points[i]);
    if (p != nullptr && may_move(*p)) out.push_back({p, result.points[i], {}});
  }
  return out;
}

void move_points(BundleEdit& edit, const RefineJob& job, const BundleResult& result, Workers& workers) {
  constexpr std::size_t kPart = 64;
  const Map& map = edit.map();
  std::vector<PointMove> moves = points_to_move(map, job, result);
  workers.each((moves.size() + kPart - 1) / kPart, [&](std::size_t part) {
    for (std::size_t i = part * kPart; i < std::min(moves.size(), (part + 1) * kPart); ++i) {
      PointMove& m = moves[i];
      m.to = m.solution ? PointEstimate{*m.solution, map.covariance_of(*m.point, *m.solution)}
                        : triangulated_anew(map, *m.point);
    }
  });
  for (const PointMove& m : moves) {
    if (m.solution) {
      move_point(edit, *m.point, *m.to);
    } else if (m.to) {
      edit.move_point(*m.point, m.to->position, m.to->covariance);
    }
  }
}

}  // namespace

RefineReport apply_refine(BundleEdit& edit, const RefineJob& job, const BundleResult& result, Workers& workers) {
  RefineReport report{.poses = static_cast<int>(job.poses.size()),
                      .points = static_cast<int>(job.points.size()),
                      .observations = static_cast<int>(job.observations.size()),
                      .sigma_px = result.sigma_px};
  if (!result.usable || job.epoch != edit.map().epoch()) return report;
  if (!lenses_may_be_taken(edit.map(), job, result)) return report;
  report.lens_step2 = lens_step2(edit.map(), job, result);
  if (job.for_lenses && report.lens_step2 < kWorthTaking2) return report;
  drop_outliers(edit, job, result, &report);
  report.lenses = take_lenses(edit, job, result);
  apply_zooms(edit, job, result);
  move_frames(edit, job, result);
  move_points(edit, job, result, workers);
  edit.raise_epoch();
  edit.note_moved(job.map, Why::kAdjusted, {static_cast<double>(report.poses), static_cast<double>(report.points)});
  report.applied = true;
  return report;
}

}  // namespace coslam
