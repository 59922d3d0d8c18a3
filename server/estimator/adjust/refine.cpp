// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/refine.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <unordered_map>
#include <unordered_set>

#include "server/estimator/adjust/certainty.h"
#include "server/estimator/adjust/holding_poses.h"
#include "server/estimator/adjust/lens.h"
#include "server/estimator/adjust/outline.h"
#include "server/estimator/adjust/zoom.h"
#include "server/estimator/associate/register.h"

namespace coslam {
namespace {

struct PoseHash {
  std::size_t operator()(const ImageKey& pose) const {
    return (std::size_t{pose.first.value} << 16U) ^ pose.second.value;
  }
};
using PoseIndex = std::unordered_map<ImageKey, int, PoseHash>;

// Ascending.
std::vector<SetId> key_frames_to_adjust(const Map& map, MapId map_id, RefineExtent extent,
                                        const BundleAdjustmentConfig& config) {
  const auto& keys = map.key_frames();
  if (keys.size() < 2) return {};
  std::vector<SetId> out;
  if (extent == RefineExtent::kWindow) {
    const std::size_t window = std::min(keys.size(), static_cast<std::size_t>(config.window));
    for (std::size_t k = keys.size() - window; k < keys.size(); ++k) out.push_back(keys[k].set);
    return out;
  }
  const KeyPoses all = key_poses(map, map_id);
  return extent == RefineExtent::kWhole ? all.sets : outline_of(all, config.outline_poses);
}

void add_pose(const Map& map, MapId map_id, SetId set, CameraId camera, bool fixed, RefineJob* job, PoseIndex* index) {
  const FramePose* f = pose_to_adjust(map, map_id, set, camera);
  if (f == nullptr) return;
  (*index)[{set, camera}] = static_cast<int>(job->problem.poses.size());
  job->problem.poses.push_back({f->cam_from_world, camera.value, fixed});
  job->poses.push_back({set, camera, f->zoom_taken_out});
}

// Which sets these poses are of: most observations of a place that was seen often are of none.
std::vector<bool> sets_of(const PoseIndex& index, SetId newest) {
  std::vector<bool> out(newest.value + 1);
  for (const auto& [key, pose] : index) out[key.first.value] = true;
  return out;
}

// Of some points, numbered from 0.
struct PointsOfJob {
  std::vector<PointId> points;
  std::vector<Eigen::Vector3d> positions;
  std::vector<BundleProblem::Observation> observations;
  std::vector<RefineJob::ObservationKey> keys;
};

PointsOfJob points_of_job(const Map& map, MapId map_id, SetId first, const PoseIndex& index,
                          const std::vector<bool>& in_job, std::span<const MapPoint* const> candidates) {
  PointsOfJob out;
  std::vector<std::pair<const KeyObservation*, int>> seen;  // with the pose
  for (const MapPoint* candidate : candidates) {
    const MapPoint& p = *candidate;
    if (p.map != map_id || !p.proven() || p.key_observations.empty()) continue;
    if (p.key_observations.back().set < first) continue;
    seen.clear();
    for (const KeyObservation& o : p.key_observations) {
      if (!in_job[o.set.value]) continue;
      if (const auto at = index.find({o.set, o.camera}); at != index.end()) seen.emplace_back(&o, at->second);
    }
    if (seen.size() < 2) continue;
    const int point = static_cast<int>(out.points.size());
    out.points.push_back(p.id);
    out.positions.push_back(p.position);
    for (const auto& [o, pose] : seen) {
      out.observations.push_back(
          {pose, point, o->undistorted_px.cast<double>(), std::max(0.5, map.camera(o->camera).sigma_px)});
      out.keys.push_back({o->set, o->track});
    }
  }
  return out;
}

void add_points(const Map& map, MapId map_id, SetId first, const PoseIndex& index, Workers& workers, RefineJob* job) {
  const std::vector<bool> in_job = sets_of(index, map.now());
  const std::vector<const MapPoint*> candidates = map.points_observed_since(first);
  std::vector<PointsOfJob> parts(workers.at_once());
  const std::size_t part_size = (candidates.size() + parts.size() - 1) / parts.size();
  workers.each(parts.size(), [&](std::size_t i) {
    const std::size_t begin = std::min(candidates.size(), i * part_size);
    const std::size_t end = std::min(candidates.size(), begin + part_size);
    parts[i] = points_of_job(map, map_id, first, index, in_job, std::span(candidates).subspan(begin, end - begin));
  });
  const auto append = [](auto* to, const auto& part) { to->insert(to->end(), part.begin(), part.end()); };
  for (const PointsOfJob& part : parts) {
    const int points_before = static_cast<int>(job->points.size());
    append(&job->points, part.points);
    append(&job->problem.points, part.positions);
    append(&job->observations, part.keys);
    for (const auto& o : part.observations) {
      job->problem.observations.push_back(o);
      job->problem.observations.back().point += points_before;
    }
  }
}

void weigh_observations(RefineJob* job) {
  const std::vector<double> worth = worth_of_observations(*job, std::vector<bool>(job->observations.size(), true));
  for (std::size_t i = 0; i < worth.size(); ++i) job->problem.observations[i].weight = worth[i];
}

// With no history to hold the window: one pose stays, and the whole is put back afterwards.
void float_free(RefineJob* job) {
  job->floating = true;
  job->problem.poses[0].fixed = true;
}

// Cameras of a rig hold each other at each key frame, where lengths are metres.
void add_ties(const Map& map, RefineJob* job) {
  if (!map.is_metric(job->map)) return;
  std::map<std::pair<SetId, std::string>, std::size_t> firsts;
  for (std::size_t pose = 0; pose < job->poses.size(); ++pose) {
    const MapCamera& camera = map.camera(job->poses[pose].camera);
    if (camera.rig.empty()) continue;
    const auto [at, added] = firsts.try_emplace({job->poses[pose].set, camera.rig}, pose);
    if (added) continue;
    const MapCamera& first = map.camera(job->poses[at->second].camera);
    job->problem.ties.push_back(
        {static_cast<int>(at->second), static_cast<int>(pose), camera.cam_from_rig * first.cam_from_rig.inverse()});
  }
}

// Of these key frames, held by so many older poses, or more where a camera needs them; empty when there is too little.
std::optional<RefineJob> plan_job(const Map& map, MapId map_id, const std::vector<SetId>& keys, std::size_t holding,
                                  RefineExtent extent, bool lenses, Workers& workers) {
  if (keys.empty()) return std::nullopt;
  RefineJob job;
  job.epoch = map.epoch();
  job.map = map_id;
  job.extent = extent;
  job.set_s = map.set_interval_s();
  for (const MapCamera& c : map.cameras()) job.problem.cameras.push_back(c.model);
  PoseIndex index;
  for (const SetId key : keys) {
    for (const MapCamera& c : map.cameras()) add_pose(map, map_id, key, c.id, false, &job, &index);
  }
  if (job.poses.size() < 2) return std::nullopt;
  const std::size_t free_poses = job.poses.size();
  if (holding > 0) {
    for (const auto& [set, camera] : holding_poses(map, map_id, keys.front(), holding)) {
      add_pose(map, map_id, set, camera, true, &job, &index);
    }
  }
  add_points(map, map_id, keys.front(), index, workers, &job);
  add_ties(map, &job);
  if (job.points.size() < 20) return std::nullopt;
  if (extent != RefineExtent::kWindow) weigh_observations(&job);
  if (job.poses.size() < free_poses + 2) float_free(&job);
  if (lenses) free_lenses(map, &job);
  return job;
}

}  // namespace

std::optional<RefineJob> plan_refine(const Map& map, MapId map_id, RefineExtent extent,
                                     const BundleAdjustmentConfig& config, Workers& workers) {
  const bool window = extent == RefineExtent::kWindow;
  auto job = plan_job(map, map_id, key_frames_to_adjust(map, map_id, extent, config),
                      window ? 3 * static_cast<std::size_t>(config.window) : 0, extent,
                      !window && config.finds_lenses(), workers);
  if (!job) return job;
  job->config.max_iterations = window ? config.max_iterations : config.final_iterations;
  return job;
}

std::optional<RefineJob> plan_outline_since(const Map& map, MapId map_id, SetId first_set,
                                            const BundleAdjustmentConfig& config, Workers& workers) {
  const int most_poses = kMostApart * config.outline_poses;
  const KeyPoses all = key_poses(map, map_id);
  const bool short_run = all.sum() <= most_poses;
  const KeyPoses chosen = short_run ? all : newest_of(all, first_set, most_poses);
  if (chosen.sets.size() < 2) return std::nullopt;
  const int holding = short_run ? 0 : config.outline_poses;
  auto job = plan_job(map, map_id, outline_of(chosen, config.outline_poses), static_cast<std::size_t>(holding),
                      RefineExtent::kOutline, config.finds_lenses(), workers);
  if (job) job->config.max_iterations = config.final_iterations;
  return job;
}

std::optional<RefineJob> plan_refine_since(const Map& map, MapId map_id, SetId last_fixed,
                                           const BundleAdjustmentConfig& config) {
  std::vector<SetId> keys = key_frames_to_adjust(map, map_id, RefineExtent::kWhole, config);
  const std::size_t all = keys.size();
  std::erase_if(keys, [&](SetId key) { return key <= last_fixed; });
  const std::size_t older = (all - keys.size()) * map.cameras().size();
  auto job = plan_job(map, map_id, keys, older, RefineExtent::kWhole, config.finds_lenses(), Workers::alone());
  if (job) job->config.max_iterations = config.final_iterations;
  return job;
}

std::optional<RefineJob> plan_newest(const Map& map, MapId map_id, int most_poses) {
  const KeyPoses keys = newest_of(key_poses(map, map_id), SetId(), most_poses);
  return plan_job(map, map_id, keys.sets, 0, RefineExtent::kWhole, false, Workers::alone());
}

BundleResult solve_refine(const RefineJob& job) {
  BundleResult result = job.problem.lenses.empty() ? solve_bundle(job.problem, job.config) : solve_with_lenses(job);
  solve_zooms(job, &result);
  if (result.usable && job.floating) put_back(job.problem, &result);
  return result;
}

}  // namespace coslam
