// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/pose/turn.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <iterator>

#include "common/geometry/rigid3.h"

namespace coslam {
namespace {

Eigen::Matrix3d turn_between(const DirectionPairs& pairs) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const auto& [before, now] : pairs) sum += now * before.transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace

std::optional<Eigen::Vector3d> common_turn_rad(DirectionPairs pairs) {
  constexpr std::size_t kFewest = 12;
  constexpr int kRounds = 3;
  if (pairs.size() < kFewest) return std::nullopt;
  Eigen::Matrix3d turn = turn_between(pairs);
  for (int round = 1; round < kRounds; ++round) {
    const auto miss = [&turn](const auto& pair) { return (turn * pair.first - pair.second).norm(); };
    std::ranges::nth_element(pairs, pairs.begin() + std::ssize(pairs) / 2, {}, miss);
    const double most = 2 * miss(pairs[pairs.size() / 2]);
    DirectionPairs inliers;
    std::ranges::copy_if(pairs, std::back_inserter(inliers), [&](const auto& pair) { return miss(pair) <= most; });
    if (inliers.size() < kFewest) break;
    turn = turn_between(inliers);
  }
  return so3_log(Eigen::Quaterniond(turn));
}

}  // namespace coslam
