// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "server/estimator/solve/bundle.h"

namespace coslam {

// Computes the variance of each pose's camera centre, the sum over three directions, that the observations of a solved
// problem leave; empty for fixed poses and for those that see too little. By Monte Carlo: noise z
// N(0, I) of the whitened residuals goes through the normal equations, H x = -J^T z, so that x has the covariance H^-1.
// The frame and scale of the map, which are not observable, are those that leave the camera centres where they are, as
// near as a similarity can: the rest is what an ATE after alignment shows. Takes as long as a few steps of
// solve_bundle(), and is accurate to a tenth. problem: as solved, sigma_px of every observation included; lenses, zooms
// and ties take no part. use: which observations count.
std::vector<std::optional<double>> centre_variances(const BundleProblem& problem, const std::vector<bool>& use);

// Tells for each observation whether it agrees with the problem as it is: no more than this many standard deviations
// off.
std::vector<bool> agreeing(const BundleProblem& problem, double sigmas);

}  // namespace coslam
