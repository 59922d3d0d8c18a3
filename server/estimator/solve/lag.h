// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"

namespace coslam {

// What a camera sees of all that moves, in one image.
struct MovingSight {
  struct Ray {
    TrackId track;
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // world, unit
  };
  TimeNs stamp_ns = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // of the camera, world
  std::vector<Ray> rays;                             // ascending tracks
};

// How well two cameras agree on how things move, if the second dates its images so much too early.
struct LagAgreement {
  double lag_s = 0;
  double agreement = 0;  // over what chance would have, at most one an instant
  int instants = 0;
};

// At an instant t both cameras see a thing turn about the line between them at one speed, wherever it is and whichever
// of its corners each of them follows: the plane through it and the two cameras is the same. Compares, every tenth of a
// second, the median over the first camera's tracks at stamp t with that over the second's at t - lag, over a fifth of
// a second each. Both ascend in time.
LagAgreement lag_agreement(std::span<const MovingSight> first, std::span<const MovingSight> second, double lag_s);

// The lag at which they agree, better than at any other that is 0.3 s and more away; empty when there is none, or when
// too little moved at too few of them.
std::optional<double> best_lag_s(std::span<const LagAgreement> lags);

}  // namespace coslam
