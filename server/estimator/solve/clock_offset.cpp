// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/clock_offset.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace coslam {
namespace {

constexpr int kHuberRounds = 2, kRounds = 6;
constexpr double kHuber = 1.4, kTukey = 3.0;  // sigmas
constexpr double kShift = 1.4;                // sigma of a stretch's shift over that of a residual
constexpr double kAlike = 2;                  // residuals in succession that share their error

double weight(double sigmas, bool huber) {
  if (huber) return std::min(1.0, kHuber / std::max(1e-12, std::abs(sigmas)));
  const double x = sigmas / kTukey;
  return std::abs(x) < 1 ? (1 - x * x) * (1 - x * x) : 0;
}

struct OffsetSystem {
  Eigen::MatrixXd a;  // instruments by rates
  Eigen::VectorXd b;  // instruments by residuals
  Eigen::MatrixXd c;  // instruments by instruments: the covariance of b
};

// Adds a stretch with its shift eliminated.
void add(const ClockStretch& s, const Eigen::VectorXd& offsets, bool huber, OffsetSystem* system) {
  const Eigen::Vector2d at(offsets[s.first], offsets[s.second]);
  const double sigma2 = s.sigma_px * s.sigma_px;
  double weights = 1 / (kShift * kShift * sigma2), residuals = 0;
  Eigen::Matrix2d a = Eigen::Matrix2d::Zero(), c = Eigen::Matrix2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero(), rates = Eigen::Vector2d::Zero(), other_rates = Eigen::Vector2d::Zero();
  for (const ClockObservation& o : s.seen) {
    const double w = o.weight * weight((o.residual_px - o.rates_px_s.dot(at)) / s.sigma_px, huber) / (kAlike * sigma2);
    a += w * o.other_rates_px_s * o.rates_px_s.transpose();
    b += w * o.residual_px * o.other_rates_px_s;
    c += w * o.other_rates_px_s * o.other_rates_px_s.transpose();
    rates += w * o.rates_px_s;
    other_rates += w * o.other_rates_px_s;
    weights += w;
    residuals += w * o.residual_px;
  }
  a -= other_rates * rates.transpose() / weights;
  b -= residuals / weights * other_rates;
  c -= other_rates * other_rates.transpose() / weights;
  const int index[2] = {s.first, s.second};
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      system->a(index[i], index[j]) += a(i, j);
      system->c(index[i], index[j]) += c(i, j);
    }
    system->b[index[i]] += b[i];
  }
}

// The first camera that each is connected with.
std::vector<int> references(int cameras, std::span<const ClockStretch> stretches) {
  std::vector<int> first(static_cast<std::size_t>(cameras));
  for (std::size_t i = 0; i < first.size(); ++i) first[i] = static_cast<int>(i);
  for (const ClockStretch& s : stretches) {
    const int a = first[static_cast<std::size_t>(s.first)], b = first[static_cast<std::size_t>(s.second)];
    if (a != b) std::replace(first.begin(), first.end(), std::max(a, b), std::min(a, b));
  }
  return first;
}

}  // namespace

std::vector<ClockOffset> solve_clock_offsets(int cameras, std::span<const ClockStretch> stretches, double prior_s) {
  constexpr double kFixed = 1e16;  // 1/s^2: 10 ns
  const std::vector<int> first = references(cameras, stretches);
  Eigen::VectorXd offsets = Eigen::VectorXd::Zero(cameras);
  Eigen::MatrixXd covariance;
  for (int round = 0; round < kRounds; ++round) {
    OffsetSystem system{Eigen::MatrixXd::Zero(cameras, cameras), Eigen::VectorXd::Zero(cameras),
                        Eigen::MatrixXd::Zero(cameras, cameras)};
    for (const ClockStretch& s : stretches) add(s, offsets, round < kHuberRounds, &system);
    for (int i = 0; i < cameras; ++i) {
      const double known = first[static_cast<std::size_t>(i)] == i ? kFixed : 1 / (prior_s * prior_s);
      system.a(i, i) += known;
      system.c(i, i) += known;
    }
    const Eigen::MatrixXd inverse = system.a.inverse();
    offsets = inverse * system.b;
    covariance = inverse * system.c * inverse.transpose();
  }
  std::vector<bool> connected(static_cast<std::size_t>(cameras), false);
  for (const ClockStretch& s : stretches) {
    connected[static_cast<std::size_t>(s.first)] = connected[static_cast<std::size_t>(s.second)] = true;
  }
  std::vector<ClockOffset> out;
  for (int i = 0; i < cameras; ++i) {
    const auto c = static_cast<std::size_t>(i);
    if (first[c] == i) {
      out.push_back({0, connected[c] ? 0 : prior_s});
    } else {
      out.push_back({offsets[i], std::sqrt(covariance(i, i))});
    }
  }
  return out;
}

}  // namespace coslam
