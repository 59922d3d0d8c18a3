// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/pose/rolling_shutter.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <optional>
#include <utility>

#include "common/geometry/rigid3.h"

namespace coslam {
namespace {

using Pairs = std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>>;  // unit, of the image before and of this one

Eigen::Matrix3d turn_between(const Pairs& pairs) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const auto& [before, now] : pairs) sum += now * before.transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
}

// What most directions did; those that did something else, of near or moving things, do not count in the end.
std::optional<Eigen::Vector3d> common_turn_rad(Pairs pairs) {
  constexpr std::size_t kFewest = 12;
  constexpr int kRounds = 3;
  if (pairs.size() < kFewest) return std::nullopt;
  Eigen::Matrix3d turn = turn_between(pairs);
  for (int round = 1; round < kRounds; ++round) {
    const auto miss = [&turn](const auto& pair) { return (turn * pair.first - pair.second).norm(); };
    std::ranges::nth_element(pairs, pairs.begin() + std::ssize(pairs) / 2, {}, miss);
    const double most = 2 * miss(pairs[pairs.size() / 2]);
    Pairs some;
    std::ranges::copy_if(pairs, std::back_inserter(some), [&](const auto& pair) { return miss(pair) <= most; });
    if (some.size() < kFewest) break;
    turn = turn_between(some);
  }
  return so3_log(Eigen::Quaterniond(turn));
}

}  // namespace

void RollingShutter::correct(TimeNs capture_ns, std::vector<SeenPlace>* places) {
  if (readout_s_ <= 0) return;
  std::unordered_map<TrackId, Eigen::Vector3d> now;
  Pairs pairs;
  for (const SeenPlace& p : *places) {
    const Eigen::Vector3d direction = camera_.normalized_from_pixel(p.undistorted_px).homogeneous().normalized();
    now.emplace(p.track, direction);
    if (const auto before = last_.find(p.track); before != last_.end()) pairs.emplace_back(before->second, direction);
  }
  const double since_s = to_seconds(capture_ns - std::exchange(last_ns_, capture_ns));
  last_ = std::move(now);
  const auto turn_rad = common_turn_rad(std::move(pairs));
  if (!turn_rad || since_s <= 0) return;
  for (SeenPlace& p : *places) {
    const double late_s = (p.raw_row_px / camera_.height_px - 0.5) * readout_s_;
    const Eigen::Vector3d back =
        so3_exp(-late_s / since_s * *turn_rad) * camera_.normalized_from_pixel(p.undistorted_px).homogeneous();
    if (back.z() > 0) p.undistorted_px = camera_.project(back);
  }
}

}  // namespace coslam
