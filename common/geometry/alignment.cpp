// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/alignment.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace coslam {
namespace {

Eigen::Vector3d mean_of(std::span<const Eigen::Vector3d> points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

Alignment no_alignment(const char* problem) {
  Alignment result;
  result.problem = problem;
  return result;
}

}  // namespace

Alignment align_points(std::span<const Eigen::Vector3d> source, std::span<const Eigen::Vector3d> target,
                       AlignmentScale scale) {
  if (source.size() != target.size()) return no_alignment("the point sets differ in size");
  if (source.size() < 3) return no_alignment("fewer than three pairs");
  const Eigen::Vector3d source_mean = mean_of(source), target_mean = mean_of(target);
  if (!source_mean.allFinite() || !target_mean.allFinite()) return no_alignment("a point is not finite");

  const double count = static_cast<double>(source.size());
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  double source_variance = 0, target_variance = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector3d s = source[i] - source_mean, t = target[i] - target_mean;
    cross += t * s.transpose() / count;
    source_variance += s.squaredNorm() / count;
    target_variance += t.squaredNorm() / count;
  }
  // Rounding of the mean leaves this much spread to points that are all the same.
  constexpr double kRounding = 1e-24;
  if (source_variance <= kRounding * (1e-12 + source_mean.squaredNorm()) ||
      target_variance <= kRounding * (1e-12 + target_mean.squaredNorm())) {
    return no_alignment("the points are all at one place");
  }

  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d d = svd.singularValues();
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) sign.z() = -1;  // no reflection, eq. (39)

  Similarity3 similarity;
  similarity.scale = scale == AlignmentScale::kFree ? d.dot(sign) / source_variance : 1.0;
  if (!(similarity.scale > 0)) return no_alignment("the point sets are unrelated");
  similarity.rotation =
      Eigen::Quaterniond(Eigen::Matrix3d(svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose()));
  similarity.rotation.normalize();
  similarity.translation = target_mean - similarity.scale * (similarity.rotation * source_mean);

  Alignment result;
  result.rotation_unique = d(1) > 1e-9 * d(0);
  double squared = 0;
  for (std::size_t i = 0; i < source.size(); ++i) squared += (target[i] - similarity * source[i]).squaredNorm();
  result.rmse = std::sqrt(squared / count);
  result.target_spread = std::sqrt(target_variance);
  result.target_from_source = similarity;
  return result;
}

}  // namespace coslam
