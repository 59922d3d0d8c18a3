// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

// Covariances of poses at wire precision: standard deviations within 3 %, correlations within 0.004, but for those that
// are so near to 1 that the matrix would lose its rank; all are then brought nearer to 0.
namespace coslam {

using PoseCovariance = Eigen::Matrix<float, 6, 6>;  // order of retract(): rotation, translation

// Six standard deviations: 0 is 0, n is 2^((n - 1) / 12 - 17), from 8e-6 to 18. Then their correlations, upper triangle
// by rows without the diagonal: n is (n - 127) / 127.
using PoseCovarianceCode = std::array<std::uint8_t, 21>;

// Quantises a covariance; entries that are not finite or negative count as 0.
PoseCovarianceCode code_of_pose_covariance(const PoseCovariance& covariance);
bool is_valid(const PoseCovarianceCode& code);                           // codes a positive semi-definite matrix
PoseCovariance decoded_pose_covariance(const PoseCovarianceCode& code);  // requires is_valid(code)
// Quantising twice changes nothing.
PoseCovariance quantised_pose_covariance(const Eigen::Matrix<double, 6, 6>& covariance);

}  // namespace coslam
