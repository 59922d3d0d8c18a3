// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/stages/zncc.h"

#include <cmath>
#include <utility>

namespace coslam {

namespace {

// Correlation over the square that stays `margin` clear of the border in a, and lies (dx, dy) from there in b.
double correlation(const PatchGrey& a, const PatchGrey& b, int margin, int dx, int dy) {
  std::int64_t sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (int row = margin; row < kPatchSide - margin; ++row) {
    const auto* pa = a.data() + row * kPatchSide;
    const auto* pb = b.data() + (row + dy) * kPatchSide + dx;
    for (int col = margin; col < kPatchSide - margin; ++col) {
      const std::int64_t x = pa[col], y = pb[col];
      sa += x;
      sb += y;
      saa += x * x;
      sbb += y * y;
      sab += x * y;
    }
  }
  const std::int64_t side = kPatchSide - 2 * margin, n = side * side;
  const double va = static_cast<double>(n * saa - sa * sa), vb = static_cast<double>(n * sbb - sb * sb);
  const double flat = 4.0 * static_cast<double>(n * n);  // a standard deviation of two grey values is noise
  if (va < flat || vb < flat) return 0;
  return static_cast<double>(n * sab - sa * sb) / std::sqrt(va * vb);
}

}  // namespace

double zncc(const PatchGrey& a, const PatchGrey& b) { return correlation(a, b, 0, 0, 0); }

bool same_centre(const PatchGrey& a, const PatchGrey& b) {
  constexpr double kMost = 0.4;
  const double here = correlation(a, b, 1, 0, 0);
  double shift2 = 0;
  for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(0, 1)}) {
    // Parabola through three values along each axis.
    const double up = correlation(a, b, 1, dx, dy), down = correlation(a, b, 1, -dx, -dy);
    const double bend = 2 * here - up - down;
    if (bend <= 0) return false;
    const double shift = (up - down) / (2 * bend);
    shift2 += shift * shift;
  }
  return shift2 <= kMost * kMost;
}

const PointPatch* nearest_patch(const MapPoint& point, const Eigen::Vector3d& view_direction) {
  const PointPatch* best = nullptr;
  double best_cosine = -2;
  for (const PointPatch& p : point.patches) {
    const double cosine = p.view_direction.dot(view_direction);
    if (cosine > best_cosine) {
      best_cosine = cosine;
      best = &p;
    }
  }
  return best;
}

}  // namespace coslam
