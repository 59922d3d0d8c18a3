// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/solve/bundle.h"

namespace coslam {

// Solves for the poses, points and lenses; solve_bundle() adds what the solution says of the observations.
// Levenberg-Marquardt with the points eliminated. With poses and lenses c and points p, blocks of the Gauss-Newton
// Hessian H and the gradient g,
//   (H_cc - H_cp H_pp^-1 H_pc) d_c = -g_c + H_cp H_pp^-1 g_p,   d_p = -H_pp^-1 (g_p + H_pc d_c);
// the system of poses and lenses is dense for few poses, else sparse by blocks, of which most are empty.
BundleResult solve_by_schur(const BundleProblem& problem, const BundleConfig& config);

}  // namespace coslam
