// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/solve/bundle.h"

namespace coslam {

// solve_bundle() where lenses are solved for too, but for what it says of the observations: by Ceres, since that is
// seldom and nobody waits for it. With no lenses given they are as calibrated.
BundleResult solve_with_lenses(const BundleProblem& problem, const BundleConfig& config);

}  // namespace coslam
