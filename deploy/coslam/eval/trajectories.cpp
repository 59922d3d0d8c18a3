// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/trajectories.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "deploy/coslam/eval/statistics.h"

namespace coslam::eval {
namespace {

constexpr TimeNs kSameTime_ns = 1'000'000;  // stamps written with few decimals
constexpr double kDegrees = 180 / std::numbers::pi;

double angle_deg(const Eigen::Quaterniond& q) { return so3_log(q).norm() * kDegrees; }

// The pair nearest to a time, or none within the tolerance.
const PosePair* nearest_pair(const PosePairs& pairs, TimeNs t_ns, TimeNs tolerance_ns) {
  const auto after =
      std::lower_bound(pairs.begin(), pairs.end(), t_ns, [](const PosePair& p, TimeNs t) { return p.t_ns < t; });
  const PosePair* best = nullptr;
  if (after != pairs.end()) best = &*after;
  if (after != pairs.begin()) {
    const PosePair& before = *std::prev(after);
    if (best == nullptr || t_ns - before.t_ns < best->t_ns - t_ns) best = &before;
  }
  return best != nullptr && std::abs(best->t_ns - t_ns) <= tolerance_ns ? best : nullptr;
}

}  // namespace

PosePairs pair_poses(const Trajectory& estimate, const Trajectory& truth, TimeNs max_gap_ns) {
  PosePairs pairs;
  if (truth.empty()) return pairs;
  for (const StampedPose& pose : estimate) {
    TimeNs t_ns = std::clamp(pose.t_ns, truth.front().t_ns, truth.back().t_ns);
    if (std::abs(t_ns - pose.t_ns) > kSameTime_ns) continue;
    if (const auto true_pose = pose_at(truth, t_ns, max_gap_ns)) {
      pairs.push_back({pose.t_ns, pose.cam_from_world, *true_pose});
    }
  }
  return pairs;
}

double path_length(const Trajectory& trajectory) {
  double length = 0;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    length += (trajectory[i].cam_from_world.center() - trajectory[i - 1].cam_from_world.center()).norm();
  }
  return length;
}

Alignment align_centers(const std::vector<PosePairs>& agents) {
  std::vector<Eigen::Vector3d> estimate, truth;
  for (const PosePairs& pairs : agents) {
    for (const PosePair& pair : pairs) {
      estimate.push_back(pair.estimate.center());
      truth.push_back(pair.truth.center());
    }
  }
  return align_points(estimate, truth, AlignmentScale::kFree);
}

namespace {

std::vector<double> center_distances(const PosePairs& pairs, const Similarity3& truth_from_map) {
  std::vector<double> distances;
  for (const PosePair& pair : pairs) {
    distances.push_back((truth_from_map * pair.estimate.center() - pair.truth.center()).norm());
  }
  return distances;
}

}  // namespace

std::optional<double> position_rmse(const PosePairs& pairs, const Similarity3& truth_from_map) {
  if (pairs.empty()) return std::nullopt;
  return root_mean_square(center_distances(pairs, truth_from_map));
}

std::optional<WorstFrame> worst_frame(const PosePairs& pairs, const Similarity3& truth_from_map) {
  if (pairs.empty()) return std::nullopt;
  std::vector<double> distances = center_distances(pairs, truth_from_map);
  const auto worst = std::max_element(distances.begin(), distances.end());
  WorstFrame out{*worst, 0, pairs[static_cast<std::size_t>(worst - distances.begin())].t_ns};
  out.median_m = percentile(distances, 50);
  return out;
}

std::optional<MotionError> motion_error(const std::vector<PosePairs>& agents, double scale, TimeNs delta_ns) {
  std::vector<double> translations, rotations;
  for (const PosePairs& pairs : agents) {
    for (const PosePair& first : pairs) {
      const PosePair* second = nearest_pair(pairs, first.t_ns + delta_ns, delta_ns / 20);
      if (second == nullptr) continue;
      Rigid3 estimate = second->estimate * first.estimate.inverse();  // second_from_first
      estimate.translation *= scale;
      const Rigid3 error = estimate * (second->truth * first.truth.inverse()).inverse();
      translations.push_back(error.translation.norm());
      rotations.push_back(angle_deg(error.rotation));
    }
  }
  if (translations.empty()) return std::nullopt;
  return MotionError{root_mean_square(translations), percentile(translations, 50), root_mean_square(rotations),
                     percentile(rotations, 50), static_cast<int>(translations.size())};
}

std::optional<double> closing_drift(const PosePairs& pairs, const Similarity3& truth_from_map) {
  if (pairs.size() < 2) return std::nullopt;
  const Eigen::Vector3d start = pairs.front().truth.center(), end = pairs.back().truth.center();
  double length = 0, farthest = 0;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    length += (pairs[i].truth.center() - pairs[i - 1].truth.center()).norm();
    farthest = std::max(farthest, (pairs[i].truth.center() - start).norm());
  }
  const double gap = (end - start).norm();
  if (length == 0 || gap > 0.05 * length || gap > 0.25 * farthest) return std::nullopt;
  const Eigen::Vector3d moved =
      truth_from_map * pairs.back().estimate.center() - truth_from_map * pairs.front().estimate.center();
  return (moved - (end - start)).norm();
}

std::optional<RelativePoseError> relative_pose_error(const PosePairs& a, const PosePairs& b, double scale) {
  constexpr TimeNs kTogether_ns = 5'000'000;
  std::vector<double> translations, scaled, rotations, baselines;
  for (const PosePair& in_a : a) {
    const PosePair* in_b = nearest_pair(b, in_a.t_ns, kTogether_ns);
    if (in_b == nullptr) continue;
    const Rigid3 estimate = in_b->estimate * in_a.estimate.inverse();  // b_from_a
    const Rigid3 truth = in_b->truth * in_a.truth.inverse();
    translations.push_back((estimate.translation - truth.translation).norm());
    scaled.push_back((scale * estimate.translation - truth.translation).norm());
    rotations.push_back(angle_deg(estimate.rotation * truth.rotation.conjugate()));
    baselines.push_back(truth.translation.norm());
  }
  if (translations.empty()) return std::nullopt;
  return RelativePoseError{percentile(translations, 50), percentile(scaled, 50), percentile(rotations, 50),
                           percentile(baselines, 50), static_cast<int>(translations.size())};
}

}  // namespace coslam::eval
