// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "common/geometry/rigid3.h"
#include "server/estimator/solve/bundle.h"
#include "server/estimator/solve/bundle_structure.h"

// Equations of a bundle adjustment: the cost of an estimate, and the normal equations around it. Used by the solver
// (bundle_schur.h) alone.
namespace coslam {

using Matrix63 = Eigen::Matrix<double, 6, 3>;

struct BundleEstimate {
  std::vector<Rigid3> poses;
  std::vector<Eigen::Matrix3d> rotations;  // one per pose
  std::vector<Eigen::Vector3d> points;
  std::vector<CorrectedLens> lenses;  // one per camera, or none; they refer to the problem's cameras
  std::vector<double> zooms;          // one per pose, or none
};
BundleEstimate start_of(const BundleProblem& problem);

// Cauchy's loss, or squares if sigmas is 0.
class BundleLoss {
 public:
  explicit BundleLoss(double sigmas) : c2_(sigmas * sigmas) {}
  double value(double d2) const { return c2_ > 0 ? c2_ * std::log1p(d2 / c2_) : d2; }
  double slope(double d2) const { return c2_ > 0 ? 1 / (1 + d2 / c2_) : 1; }

 private:
  double c2_;
};

double cost_of(const BundleProblem& problem, const BundleStructure& s, const BundleLoss& loss, const BundleEstimate& e);

// Normal equations around an estimate, without damping.
struct BundleSystem {
  std::vector<Matrix6d> columns;  // diagonal blocks
  std::vector<Vector6d> column_gradients;
  std::vector<Eigen::Matrix3d> points;
  std::vector<Eigen::Vector3d> point_gradients;
  std::vector<Matrix63> links;
  std::vector<std::pair<std::pair<int, int>, Matrix6d>> ties;  // (row, column) of the lower half
};
BundleSystem system_around(const BundleProblem& problem, const BundleStructure& s, const BundleLoss& loss,
                           const BundleEstimate& e);

}  // namespace coslam
