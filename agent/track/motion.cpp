// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/motion.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "agent/track/match_limits.h"

namespace coslam {
namespace {

constexpr int kShiftSide = 2 * kShiftRadius + 1;

// Zero-mean normalised cross-correlation of the two images where they overlap after the shift.
float zncc_at_shift(const PyramidLevel& from, const PyramidLevel& to, int dx, int dy) {
  const int x0 = std::max(0, -dx), x1 = std::min(from.cols(), from.cols() - dx);
  const int y0 = std::max(0, -dy), y1 = std::min(from.rows(), from.rows() - dy);
  int a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  for (int y = y0; y < y1; ++y) {
    const std::uint8_t* p = from.at(x0, y);
    const std::uint8_t* q = to.at(x0 + dx, y + dy);
    for (int x = 0; x < x1 - x0; ++x) {
      a += p[x];
      b += q[x];
      aa += p[x] * p[x];
      bb += q[x] * q[x];
      ab += p[x] * q[x];
    }
  }
  const double n = (x1 - x0) * (y1 - y0);
  const double va = aa - a / n * a, vb = bb - b / n * b;
  return va > 0 && vb > 0 ? static_cast<float>((ab - a / n * b) / std::sqrt(va * vb)) : 0.0f;
}

// The image around a place, by whole pixels from it. A place outside is taken to the border.
class Bilinear {
 public:
  Bilinear(const PyramidLevel& level, const Eigen::Vector2f& px) : stride_(level.stride()) {
    const float x = std::clamp(px.x(), 0.0f, static_cast<float>(level.cols() - 1));
    const float y = std::clamp(px.y(), 0.0f, static_cast<float>(level.rows() - 1));
    const int ix = static_cast<int>(x), iy = static_cast<int>(y);
    pixel_ = level.at(ix, iy);
    a_ = x - static_cast<float>(ix);
    b_ = y - static_cast<float>(iy);
  }
  float operator()(int dx, int dy) const {
    const std::uint8_t* p = pixel_ + dy * stride_ + dx;
    const std::uint8_t* q = p + stride_;
    return (1 - b_) * ((1 - a_) * p[0] + a_ * p[1]) + b_ * ((1 - a_) * q[0] + a_ * q[1]);
  }

 private:
  std::ptrdiff_t stride_;
  const std::uint8_t* pixel_ = nullptr;
  float a_ = 0, b_ = 0;
};

float vertex(float before, float at, float after) {
  const float curvature = before - 2 * at + after;
  return curvature < 0 ? std::clamp(0.5f * (before - after) / curvature, -0.5f, 0.5f) : 0.0f;
}

}  // namespace

Eigen::Vector2f global_shift(const Pyramid& from, const Pyramid& to) {
  const int top = from.levels() - 1;
  const PyramidLevel& a = from.level(top);
  const PyramidLevel& b = to.level(top);
  const int rx = std::min(kShiftRadius, a.cols() / 3), ry = std::min(kShiftRadius, a.rows() / 3);
  std::array<std::array<float, kShiftSide + 2>, kShiftSide + 2> zncc{};
  int best_x = 0, best_y = 0;
  const auto at = [&](int dx, int dy) -> float& {
    return zncc[static_cast<std::size_t>(dy + kShiftRadius + 1)][static_cast<std::size_t>(dx + kShiftRadius + 1)];
  };
  for (int dy = -ry; dy <= ry; ++dy) {
    for (int dx = -rx; dx <= rx; ++dx) {
      at(dx, dy) = zncc_at_shift(a, b, dx, dy);
      if (at(dx, dy) > at(best_x, best_y)) best_x = dx, best_y = dy;
    }
  }
  const float best = at(best_x, best_y);
  const Eigen::Vector2f shift(
      static_cast<float>(best_x) + vertex(at(best_x - 1, best_y), best, at(best_x + 1, best_y)),
      static_cast<float>(best_y) + vertex(at(best_x, best_y - 1), best, at(best_x, best_y + 1)));
  return shift * static_cast<float>(1 << top);
}

std::vector<bool> moves_apart(const std::vector<Eigen::Vector2f>& from_px, const std::vector<Eigen::Vector2f>& to_px) {
  constexpr std::size_t kLeastTracks = 20;
  constexpr int kRounds = 5;
  constexpr float kLeast_px = 1.5f;  // above what tracking leaves
  constexpr float kOfMedian = 4.0f;  // of the others' distances from the model
  const std::size_t n = from_px.size();
  if (n < kLeastTracks) return std::vector<bool>(n, false);
  std::vector<float> distances(n, 0.0f), sorted;
  float median = 1e6f;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3f normal = 1e-3f * Eigen::Matrix3f::Identity();
    Eigen::Matrix<float, 3, 2> right = Eigen::Matrix<float, 3, 2>::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      const float miss = distances[i] / std::max(2 * median, 0.5f);
      const float weight = 1 / (1 + miss * miss);
      const Eigen::Vector3f at(from_px[i].x() * 0.01f, from_px[i].y() * 0.01f, 1);
      normal += weight * at * at.transpose();
      right += weight * at * (to_px[i] - from_px[i]).transpose();
    }
    const Eigen::Matrix<float, 3, 2> model = normal.ldlt().solve(right);
    for (std::size_t i = 0; i < n; ++i) {
      const Eigen::Vector3f at(from_px[i].x() * 0.01f, from_px[i].y() * 0.01f, 1);
      distances[i] = (to_px[i] - from_px[i] - model.transpose() * at).norm();
    }
    sorted = distances;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(n / 2), sorted.end());
    median = sorted[n / 2];
  }
  std::vector<bool> apart;
  apart.reserve(n);
  for (const float d : distances) apart.push_back(d > std::max(kLeast_px, kOfMedian * median));
  return apart;
}

float difference_of_middles(const PyramidLevel& a, const Eigen::Vector2f& a_px, const PyramidLevel& b,
                            const Eigen::Vector2f& b_px) {
  constexpr int kHalf = 3;
  float sum = 0;
  const Bilinear in_a(a, a_px), in_b(b, b_px);
  for (int y = -kHalf; y <= kHalf; ++y) {
    for (int x = -kHalf; x <= kHalf; ++x) {
      const float difference = in_a(x, y) - in_b(x, y);
      sum += difference * difference;
    }
  }
  return sum / ((2 * kHalf + 1) * (2 * kHalf + 1));
}

Eigen::Vector2f MotionField::near(const Eigen::Vector2f& px) {
  constexpr std::size_t kMost = kMotionNeighbours;
  const std::size_t count = std::min(kMost, samples_.size());
  const auto middle = samples_.begin() + static_cast<std::ptrdiff_t>(count);
  std::partial_sort(samples_.begin(), middle, samples_.end(), [&](const Sample& a, const Sample& b) {
    return (a.at_px - px).squaredNorm() < (b.at_px - px).squaredNorm();
  });
  std::array<float, kMost> x, y;
  x.fill(std::numeric_limits<float>::infinity());
  y.fill(std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < count; ++i) {
    x[i] = samples_[i].motion_px.x();
    y[i] = samples_[i].motion_px.y();
  }
  const auto median = [count](std::array<float, kMost>& values) {
    std::ranges::sort(values);
    return values[count / 2];
  };
  return {median(x), median(y)};
}

}  // namespace coslam
