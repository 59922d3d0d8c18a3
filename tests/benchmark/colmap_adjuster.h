// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "server/estimator/solve/bundle.h"

namespace coslam::benchmarks {

struct ColmapAdjustment {
  BundleProblem solved;  // poses and points as COLMAP left them
  double solver_s = 0;   // as it says itself: without reading and writing the model
};

// What `colmap bundle_adjuster` makes of a problem without lenses' distortion, ties or outliers: written as a model,
// solved for poses and points by squares in one thread, to the same tolerance. Throws UserError when it fails; nullopt:
// COLMAP is not installed.
std::optional<ColmapAdjustment> adjust_by_colmap(const BundleProblem& problem, const BundleConfig& config);

}  // namespace coslam::benchmarks
