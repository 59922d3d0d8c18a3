// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "common/dataset/trajectory.h"
#include "common/geometry/alignment.h"

// Accuracy of camera paths. Estimates are in the map frame, truth in its own; a Similarity3 named truth_from_map joins
// them.
namespace coslam::eval {

struct PosePair {
  TimeNs t_ns = 0;
  Rigid3 estimate;  // cam_from_world
  Rigid3 truth;     // cam_from_world
};
using PosePairs = std::vector<PosePair>;

// The truth at each estimated pose's time, interpolated over gaps of at most max_gap_ns; poses without are left out.
PosePairs pair_poses(const Trajectory& estimate, const Trajectory& truth, TimeNs max_gap_ns);

// Sum of the straight steps between camera centres.
double path_length(const Trajectory& trajectory);

// One similarity for all camera centres of all agents together; its rmse is the joint absolute trajectory error.
Alignment align_centers(const std::vector<PosePairs>& agents);

// Root mean square distance of the centres under a given similarity; empty without pairs.
std::optional<double> position_rmse(const PosePairs& pairs, const Similarity3& truth_from_map);

// The frame that is farthest off, beside the others of its path; empty without pairs.
struct WorstFrame {
  double error_m = 0, median_m = 0;
  TimeNs t_ns = 0;
};
std::optional<WorstFrame> worst_frame(const PosePairs& pairs, const Similarity3& truth_from_map);

// Error of the motion over a fixed time, in the camera frame.
struct MotionError {
  double translation_rmse_m = 0, translation_median_m = 0;
  double rotation_rmse_deg = 0, rotation_median_deg = 0;
  int count = 0;
};
std::optional<MotionError> motion_error(const std::vector<PosePairs>& agents, double scale, TimeNs delta_ns);

// Error of the estimated end, seen from the start, when the true path ends where it began (within 5 % of its length,
// after having been four times as far away); empty for an open path.
std::optional<double> closing_drift(const PosePairs& pairs, const Similarity3& truth_from_map);

// Error of cam_b_from_cam_a at common times, medians. Needs no alignment, so that it tells the metric error.
struct RelativePoseError {
  double translation = 0;         // map lengths against metres: the error in metres when the map is metric
  double translation_scaled = 0;  // with the scale of the alignment
  double rotation_deg = 0;
  double baseline_m = 0;  // true distance of the two cameras
  int count = 0;
};
std::optional<RelativePoseError> relative_pose_error(const PosePairs& a, const PosePairs& b, double scale);

}  // namespace coslam::eval
