// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/estimator/solve/bundle.h"

namespace coslam {

// Computes what the uncertainty of the poses adds to the covariance of every point of a solved problem: with its
// Hessian in blocks, poses c and points p, and Sigma_c = (H_cc - H_cp H_pp^-1 H_pc)^-1,
//   (H_pp^-1 H_pc) Sigma_c (H_pp^-1 H_pc)^T,
// so that covariance with exact poses + this = marginal covariance. The frame and scale of the map, which are not
// observable, are those in which the camera centres as a whole stay where they are.
// problem: as solved, sigma_px of every observation included; poses with fixed = true count as exact. Observations with
// use = false are left out; a point without any gets zero. At most `max_poses` of the poses take part, evenly chosen,
// so that time and memory stay bounded (some 2 s for 200 poses); the rest would make the result smaller.
std::vector<Eigen::Matrix3d> share_of_poses(const BundleProblem& problem, const std::vector<bool>& use,
                                            std::size_t max_poses);

}  // namespace coslam
