// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/turning.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

namespace coslam {
namespace {

constexpr double kMostOffset_s = 10, kStep_s = 0.02;
constexpr double kOver_s = 0.2;      // an angle is taken over that long, so that the noise of poses does not count
constexpr double kLeastPosed_s = 4;  // in which both have poses
constexpr double kAlike = 0.05;      // what is left of the turns of cameras that are held together, squared
constexpr double kElsewhere = 0.2;   // that is left at lags half a second and more away, at least
constexpr double kOtherPeak_s = 0.5;
constexpr double kLeast_rad = 0.01;  // an angle in the mean, far above the noise of poses

struct Series {
  TimeNs begin_ns = 0;
  std::vector<std::optional<Eigen::Vector3d>> turn_rad;  // as a rotation vector in the camera's frame; one each kStep_s
};

Series turns(const Trajectory& path) {
  Series out{path.front().t_ns, {}};
  for (TimeNs t = out.begin_ns; t + to_ns(kOver_s) <= path.back().t_ns; t += to_ns(kStep_s)) {
    const auto from = pose_at(path, t, to_ns(kOver_s)), to = pose_at(path, t + to_ns(kOver_s), to_ns(kOver_s));
    if (!from || !to) {
      out.turn_rad.emplace_back();
      continue;
    }
    const Eigen::AngleAxisd turn(to->rotation * from->rotation.conjugate());
    out.turn_rad.emplace_back(turn.angle() * turn.axis());
  }
  return out;
}

// The share that is left of the turns of two cameras, squared, when one of them is turned into the frame of the other
// as well as one rotation can (Wahba's problem), over the instants that both know, the second's taken so many steps
// earlier. 0: one body; near 1: nothing to do with each other.
std::optional<double> left_over(const Series& a, const Series& b, int earlier) {
  double n = 0, sum2 = 0;
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  for (int i = 0; i < static_cast<int>(a.turn_rad.size()); ++i) {
    const int j = i - earlier;
    if (j < 0 || j >= static_cast<int>(b.turn_rad.size())) continue;
    const auto &x = a.turn_rad[static_cast<std::size_t>(i)], &y = b.turn_rad[static_cast<std::size_t>(j)];
    if (!x || !y) continue;
    n += 1;
    sum2 += x->squaredNorm() + y->squaredNorm();
    products += *x * y->transpose();
  }
  if (n * kStep_s < kLeastPosed_s || sum2 < 2 * n * kLeast_rad * kLeast_rad) return std::nullopt;
  // Horn's matrix, whose greatest eigenvalue is the sum of the products under the best rotation.
  const Eigen::Vector3d skew(products(1, 2) - products(2, 1), products(2, 0) - products(0, 2),
                             products(0, 1) - products(1, 0));
  Eigen::Matrix4d horn;
  horn(0, 0) = products.trace();
  horn.block<1, 3>(0, 1) = skew.transpose();
  horn.block<3, 1>(1, 0) = skew;
  horn.block<3, 3>(1, 1) = products + products.transpose() - products.trace() * Eigen::Matrix3d::Identity();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(horn, Eigen::EigenvaluesOnly);
  return 1 - 2 * eigen.eigenvalues().maxCoeff() / sum2;
}

}  // namespace

std::optional<double> lag_by_turning_s(const Trajectory& first, const Trajectory& second) {
  if (first.size() < 2 || second.size() < 2) return std::nullopt;
  const Series a = turns(first), b = turns(second);
  const auto apart = static_cast<int>(std::lround(to_seconds(b.begin_ns - a.begin_ns) / kStep_s));
  struct Left {
    int lag;
    double share;
  };
  std::vector<Left> known;
  const int most = static_cast<int>(kMostOffset_s / kStep_s);
  for (int lag = -most; lag <= most; ++lag) {
    if (const auto share = left_over(a, b, lag + apart)) known.push_back({lag, *share});
  }
  if (known.empty()) return std::nullopt;
  const Left best = *std::ranges::min_element(known, {}, &Left::share);
  if (best.share > kAlike) return std::nullopt;
  const bool rival = std::ranges::any_of(known, [&](const Left& other) {
    return std::abs(other.lag - best.lag) * kStep_s > kOtherPeak_s && other.share < kElsewhere;
  });
  return rival ? std::nullopt : std::optional(best.lag * kStep_s);
}

}  // namespace coslam
