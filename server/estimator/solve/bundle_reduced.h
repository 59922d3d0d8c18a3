// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/CholmodSupport>
#include <Eigen/SparseCore>
#include <optional>
#include <vector>

#include "server/estimator/solve/bundle_equations.h"

namespace coslam {

// What is added to a diagonal: a share of itself.
template <class Block>
auto damping(const Block& block, double radius) {
  constexpr double kLeast = 1e-6;
  return (block.diagonal().array().max(kLeast) / radius).matrix().eval();
}

// The points, damped, so that they can be left out of the system.
struct Eliminated {
  std::vector<Eigen::Vector3d> dampings;
  std::vector<Eigen::Matrix3d> inverse;
  std::vector<Matrix63> by_points;  // H_cp H_pp^-1 of each link
};
Eliminated eliminate(const BundleStructure& s, const BundleSystem& system, double radius);

// The lower half of the system of poses and lenses that is left without the points, by its blocks. Refers to the
// structure.
class ReducedSystem {
 public:
  explicit ReducedSystem(const BundleStructure& s);

  // links_by_points: H_cp H_pp^-1. False when it is not positive definite.
  bool factor(const BundleSystem& system, double radius, const std::vector<Matrix63>& links_by_points);
  // x for *this x = b, once it is factored.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

 private:
  using Sparse = Eigen::SparseMatrix<double>;
  bool is_dense() const;
  void fill(const BundleSystem& system, double radius, const std::vector<Matrix63>& links_by_points);
  bool factor_dense();
  bool factor_sparse();
  void make_pattern();

  const BundleStructure& s_;
  std::vector<std::size_t> first_;  // block of each column, and one beyond the last
  std::vector<Matrix6d> blocks_;
  std::vector<std::size_t> slot_;  // of a row among those of the column in work
  Eigen::MatrixXd dense_;
  std::optional<Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>> dense_factor_;  // in its place
  Sparse sparse_;
  Eigen::CholmodDecomposition<Sparse, Eigen::Lower> sparse_factor_;
};

}  // namespace coslam
