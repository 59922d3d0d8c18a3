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

// Levenberg-Marquardt damping of a block: a share of its diagonal, which is added to it.
template <class Block>
auto damping(const Block& block, double radius) {
  constexpr double kLeast = 1e-6;
  return (block.diagonal().array().max(kLeast) / radius).matrix().eval();
}

// Damped point blocks and their inverses, with which the points are eliminated from the system.
struct Eliminated {
  std::vector<Eigen::Vector3d> dampings;
  std::vector<Eigen::Matrix3d> inverse;
  std::vector<Matrix63> by_points;  // H_cp H_pp^-1 of each link
};
Eliminated eliminate(const BundleStructure& s, const BundleSystem& system, double radius);

// Schur complement: the lower half, by blocks, of the system of poses and lenses after the points are eliminated.
// Refers to the structure.
class ReducedSystem {
 public:
  explicit ReducedSystem(const BundleStructure& s);

  // Factorises the system; links_by_points: H_cp H_pp^-1. False when it is not positive definite.
  bool factor(const BundleSystem& system, double radius, const std::vector<Matrix63>& links_by_points);
  // Solves *this x = b for x, after factor().
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

 private:
  using Sparse = Eigen::SparseMatrix<double>;
  bool is_dense() const;
  void fill(const BundleSystem& system, double radius, const std::vector<Matrix63>& links_by_points);
  bool factor_dense();
  bool factor_sparse();
  void make_pattern();

  const BundleStructure& s_;
  std::vector<std::size_t> first_;  // index into blocks_ of each column's first block, and one beyond the last
  std::vector<Matrix6d> blocks_;
  std::vector<std::size_t> slot_;  // place of each row among the blocks of the column in work
  Eigen::MatrixXd dense_;
  std::optional<Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>> dense_factor_;  // factorises dense_ in place
  Sparse sparse_;
  Eigen::CholmodDecomposition<Sparse, Eigen::Lower> sparse_factor_;
};

}  // namespace coslam
