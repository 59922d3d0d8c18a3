// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "common/geometry/rigid3.h"
#include "server/estimator/solve/bundle.h"

// The equations of a bundle adjustment: who sees what, the cost of an estimate, and the normal equations around it. For
// the solver (bundle_schur.h) alone.
namespace coslam {

using Matrix63 = Eigen::Matrix<double, 6, 3>;

struct BundleEstimate {
  std::vector<Rigid3> poses;
  std::vector<Eigen::Matrix3d> rotations;  // of the poses
  std::vector<Eigen::Vector3d> points;
  std::vector<CorrectedLens> lenses;  // by camera, or none; they refer to the problem's cameras
  std::vector<double> zooms;          // of the poses, or none
};
BundleEstimate start_of(const BundleProblem& problem);

// What does not change while it is solved: who sees what. Columns are of what is free: poses; then lenses, of which
// each half is as large as a pose; then zooms, six poses of one camera together.
struct BundleStructure {
  static constexpr int kHalves = LensCorrection::kTerms / 6, kZooms = 6;
  // A column and one point that is seen from or through it.
  struct Link {
    int column, point;
  };
  std::vector<int> column_of;       // of each pose; -1: fixed
  std::vector<int> lens_column_of;  // first one of each camera; -1: its lens is given
  // Where the zoom of each pose is; column -1: it has none.
  struct ZoomPlace {
    int column = -1, slot = 0;
  };
  std::vector<ZoomPlace> zoom_of;
  int columns = 0;
  std::vector<Eigen::Matrix2d> whiten;  // of each observation, from undistorted px to standard deviations
  std::vector<Eigen::Vector2d> raw_px;  // the same observation in the raw image, where there are lenses
  std::vector<int> link_of;             // of each observation; -1: its pose is fixed
  std::array<std::vector<int>, kHalves> lens_link_of;  // the same of its camera's lens
  std::vector<int> zoom_link_of;                       // the same of the zoom of its pose
  std::vector<Link> links;                             // ascending points, then columns
  std::vector<int> links_end;                          // one beyond the last link of each point
  std::vector<std::vector<int>> links_at;              // of each column
  std::vector<std::vector<int>> rows_at;  // of each column: those of its blocks that are not empty, the diagonal first
};
BundleStructure structure_of(const BundleProblem& problem);

// Cauchy's loss, or squares.
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

inline std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace coslam
