// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "common/geometry/rigid3.h"

namespace coslam {

enum class AlignmentScale { kFree, kFixed };  // Sim(3) or SE(3)

struct Alignment {
  std::optional<Similarity3> target_from_source;  // empty: see problem
  double rmse = 0;              // root mean square of |target - target_from_source * source|, in the target's unit
  double target_spread = 0;     // root mean square distance of the target from its mean: what knowing nothing is off by
  bool rotation_unique = true;  // false for points on a line: the turn about it is arbitrary, the residual is not
  const char* problem = "";     // why there is no alignment
};

// Least-squares similarity between paired points: S. Umeyama, "Least-squares estimation of transformation parameters
// between two point patterns", PAMI 13(4), 1991, eqs. (38) to (43).
Alignment align_points(std::span<const Eigen::Vector3d> source, std::span<const Eigen::Vector3d> target,
                       AlignmentScale scale);

}  // namespace coslam
