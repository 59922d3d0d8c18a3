// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"

namespace coslam {

// Least number of tracks whose median tells how fast things turn.
inline constexpr std::size_t kLeastTracks = 4;

// Rays of one image towards moving points.
struct MovingSight {
  struct Ray {
    TrackId track;
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // world, unit
  };
  TimeNs stamp_ns = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // camera centre, world
  std::vector<Ray> rays;                             // sorted by track
};

// Agreement of two cameras on how things move, if the second camera's stamps were this much too early.
struct LagAgreement {
  double lag_s = 0;
  double agreement = 0;  // above the agreement expected by chance, at most one per instant
  int instants = 0;
};

// Measures how well two cameras agree for one lag. At an instant t both cameras see a thing turn about the line between
// them at one speed, wherever it is and whichever of its corners each of them follows: the plane through it and the two
// cameras is the same. Compares, every tenth of a second, the median over the first camera's tracks at stamp t with
// that over the second's at t - lag, over a fifth of a second each. Both are sorted by time.
LagAgreement lag_agreement(std::span<const MovingSight> first, std::span<const MovingSight> second, double lag_s);

// Returns the lag with the best agreement, which has to be better than that at any lag 0.3 s and more away; empty when
// there is none, or when too little moved at too few instants.
std::optional<double> best_lag_s(std::span<const LagAgreement> lags);

}  // namespace coslam
