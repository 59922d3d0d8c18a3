// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/model/pose_covariance.h"

#include <algorithm>
#include <cmath>

namespace coslam {
namespace {

constexpr int kSize = 6;
constexpr double kStepsAnOctave = 12, kLeastOctave = -17;
constexpr int kMostCorrelation = 127;
// Least square of a pivot of the correlations: the writer keeps off the reader's limit, which has room for rounding.
constexpr double kLeastWritten = 2e-4, kLeastRead = 1e-4;
constexpr double kShrink = 0.98;

using Matrix = Eigen::Matrix<double, kSize, kSize>;

std::uint8_t code_of_sigma(double variance) {
  if (!(variance > 0) || !std::isfinite(variance)) return 0;
  const double code = 1 + std::round(kStepsAnOctave * (0.5 * std::log2(variance) - kLeastOctave));
  return static_cast<std::uint8_t>(std::clamp(code, 1.0, 255.0));
}

double sigma_of(std::uint8_t code) { return code == 0 ? 0 : std::exp2((code - 1) / kStepsAnOctave + kLeastOctave); }

std::uint8_t code_of_correlation(double covariance, double variances, double shrink) {
  const double correlation = covariance / std::sqrt(variances);
  if (!std::isfinite(correlation)) return kMostCorrelation;
  return static_cast<std::uint8_t>(kMostCorrelation +
                                   std::lround(kMostCorrelation * shrink * std::clamp(correlation, -1.0, 1.0)));
}

Matrix correlations_of(const PoseCovarianceCode& code) {
  Matrix m = Matrix::Identity();
  std::size_t next = kSize;
  for (int row = 0; row < kSize; ++row) {
    for (int col = row + 1; col < kSize; ++col) {
      m(row, col) = (code[next++] - kMostCorrelation) / static_cast<double>(kMostCorrelation);
      m(col, row) = m(row, col);  // NOLINT: symmetric
    }
  }
  return m;
}

// By Cholesky's decomposition.
bool has_pivots_above(Matrix m, double least) {
  for (int i = 0; i < kSize; ++i) {
    if (!(m(i, i) >= least)) return false;
    for (int row = i + 1; row < kSize; ++row) {
      for (int col = i + 1; col < kSize; ++col) m(row, col) -= m(row, i) * m(i, col) / m(i, i);
    }
  }
  return true;
}

}  // namespace

PoseCovarianceCode code_of_pose_covariance(const PoseCovariance& covariance) {
  const Matrix m = covariance.cast<double>();
  PoseCovarianceCode code{};
  for (int i = 0; i < kSize; ++i) code[static_cast<std::size_t>(i)] = code_of_sigma(m(i, i));
  for (double shrink = 1;; shrink *= kShrink) {
    std::size_t next = kSize;
    for (int row = 0; row < kSize; ++row) {
      for (int col = row + 1; col < kSize; ++col) {
        code[next++] = code_of_correlation(m(row, col), m(row, row) * m(col, col), shrink);
      }
    }
    if (has_pivots_above(correlations_of(code), kLeastWritten)) return code;
  }
}

bool is_valid(const PoseCovarianceCode& code) {
  return std::find(code.begin() + kSize, code.end(), 255) == code.end() &&
         has_pivots_above(correlations_of(code), kLeastRead);
}

PoseCovariance decoded_pose_covariance(const PoseCovarianceCode& code) {
  Eigen::Matrix<double, kSize, 1> sigmas;
  for (int i = 0; i < kSize; ++i) sigmas[i] = sigma_of(code[static_cast<std::size_t>(i)]);
  const Matrix products = sigmas * sigmas.transpose();
  return products.cwiseProduct(correlations_of(code)).cast<float>();
}

PoseCovariance quantised_pose_covariance(const Eigen::Matrix<double, 6, 6>& covariance) {
  return decoded_pose_covariance(code_of_pose_covariance(covariance.cast<float>()));
}

}  // namespace coslam
