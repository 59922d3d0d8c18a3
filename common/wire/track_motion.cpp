// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/track_motion.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace coslam {
namespace {

constexpr int kAffineBits = 16, kSecondOrderBits = 29;
constexpr std::size_t kMostLookedAt = 512;  // tracks among which neighbours are sought: bounds the time of large frames
constexpr std::size_t kNeighbours = 3;
constexpr std::int64_t kNear = 160, kFar = 960;  // units: nearer ones count alike, one at kFar as much as no deviation
constexpr std::size_t kLeastTracks = 8;          // fewer make no motion
constexpr int kRounds = 8;

std::int32_t clamped(std::int64_t units) {
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(units, -kMostUnits, kMostUnits));
}

std::int64_t squared_distance(Units a, Units b) {
  const std::int64_t dx = a.x - b.x, dy = a.y - b.y;
  return dx * dx + dy * dy;
}

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Rows = Eigen::Matrix<double, 2, 8>;

// Of the shift by the parameters; lengths in units of 2^13, an image's quarter or half, so that all have one size.
constexpr double kLength = 8192;

Rows derivative(Units at, Units centre) {
  const double u = (at.x - centre.x) / kLength, v = (at.y - centre.y) / kLength;
  Rows rows;
  rows << 1, u, v, 0, 0, 0, u * u, u * v, 0, 0, 0, 1, u, v, u * v, v * v;
  return rows;
}

Eigen::Vector2d shift(const Step& s) { return Eigen::Vector2d(s.to.x - s.from.x, s.to.y - s.from.y); }

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Vector8d solve(Units centre, const std::vector<Step>& steps, const std::vector<double>& weights) {
  Eigen::Matrix<double, 8, 8> normal = 1e-6 * Eigen::Matrix<double, 8, 8>::Identity();
  Vector8d right = Vector8d::Zero();
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Rows rows = derivative(steps[i].from, centre);
    normal += weights[i] * rows.transpose() * rows;
    right += weights[i] * rows.transpose() * shift(steps[i]);
  }
  return normal.ldlt().solve(right);
}

}  // namespace

Units CommonMotion::shift_at(Units at) const {
  const std::int64_t u = at.x - centre_.x, v = at.y - centre_.y;
  const std::int64_t second = p_[6] * u + p_[7] * v;
  const auto sum = [&](int first, std::int64_t along) {
    const auto p = [&](int i) { return static_cast<std::int64_t>(p_[static_cast<std::size_t>(first + i)]); };
    constexpr std::int64_t kOne = 1LL << kSecondOrderBits, kAffine = 1LL << (kSecondOrderBits - kAffineBits);
    return (p(0) * kOne + (p(1) * u + p(2) * v) * kAffine + second * along + kOne / 2) >> kSecondOrderBits;
  };
  return {static_cast<std::int32_t>(sum(0, u)), static_cast<std::int32_t>(sum(3, v))};
}

Units centre_of(const std::vector<Units>& tracks) {
  std::int64_t x = 0, y = 0;
  for (const Units& t : tracks) {
    x += t.x;
    y += t.y;
  }
  const auto count = std::max<std::int64_t>(1, static_cast<std::int64_t>(tracks.size()));
  return {static_cast<std::int32_t>(x / count), static_cast<std::int32_t>(y / count)};
}

// Reweighted least squares, almost the least sum of distances: those are what the bits grow with.
MotionParameters fit_motion(Units centre, const std::vector<Step>& steps) {
  MotionParameters parameters{};
  if (steps.size() < kLeastTracks) return parameters;
  std::vector<double> weights(steps.size(), 1.0), errors(steps.size());
  Vector8d solution;
  for (int round = 0; round < kRounds; ++round) {
    solution = solve(centre, steps, weights);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      errors[i] = (derivative(steps[i].from, centre) * solution - shift(steps[i])).norm();
    }
    const double usual = std::max(2.0, 1.5 * median(errors));
    for (std::size_t i = 0; i < steps.size(); ++i) weights[i] = 1 / (1 + errors[i] / usual);
  }
  const double affine = std::exp2(kAffineBits) / kLength, second = std::exp2(kSecondOrderBits) / (kLength * kLength);
  const std::array<double, 8> scale = {1, affine, affine, 1, affine, affine, second, second};
  for (std::size_t i = 0; i < scale.size(); ++i) {
    const double value = scale[i] * solution[static_cast<Eigen::Index>(i)];
    if (std::isfinite(value))
      parameters[i] = static_cast<std::int16_t>(std::lround(std::clamp(value, -32767.0, 32767.0)));
  }
  return parameters;
}

TrackPredictor::TrackPredictor(const CommonMotion& motion, std::size_t count) : motion_(motion) {
  seen_.reserve(std::min(count, kMostLookedAt));
}

Units TrackPredictor::predict(Units from) {
  const Units shift = motion_.shift_at(from);
  from_ = from;
  moved_ = {clamped(std::int64_t{from.x} + shift.x), clamped(std::int64_t{from.y} + shift.y)};
  const Units deviation = deviation_near(from);
  return {clamped(std::int64_t{moved_.x} + deviation.x), clamped(std::int64_t{moved_.y} + deviation.y)};
}

void TrackPredictor::observe(Units to) {
  if (seen_.size() < kMostLookedAt) seen_.push_back({from_, {to.x - moved_.x, to.y - moved_.y}});
}

Units TrackPredictor::deviation_near(Units at) const {
  struct Neighbour {
    std::int64_t distance = INT64_MAX;
    Units offset;
  };
  std::array<Neighbour, kNeighbours> nearest;  // ascending
  for (const Deviation& d : seen_) {
    const std::int64_t distance = squared_distance(d.from, at);
    if (distance >= nearest.back().distance) continue;
    std::size_t place = kNeighbours - 1;
    for (; place > 0 && nearest[place - 1].distance > distance; --place) nearest[place] = nearest[place - 1];
    nearest[place] = {distance, d.offset};
  }
  constexpr std::int64_t kOne = 1LL << 40;
  std::int64_t sum = kOne / (kFar * kFar), x = 0, y = 0;
  for (const Neighbour& n : nearest) {
    if (n.distance == INT64_MAX) break;
    const std::int64_t weight = kOne / (n.distance + kNear * kNear);
    sum += weight;
    x += weight * n.offset.x;
    y += weight * n.offset.y;
  }
  return {static_cast<std::int32_t>(x / sum), static_cast<std::int32_t>(y / sum)};
}

}  // namespace coslam
