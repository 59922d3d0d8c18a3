// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/solve/bundle.h"

namespace coslam::test {

// solve_bundle() by Ceres, but for what it says of the observations and of how well lenses are known.
BundleResult solve_by_ceres(const BundleProblem& problem, const BundleConfig& config);

}  // namespace coslam::test
