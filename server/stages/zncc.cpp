// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/stages/zncc.h"

#include <cmath>

namespace coslam {

double zncc(const PatchGrey& a, const PatchGrey& b) {
  std::int64_t sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::int64_t x = a[i], y = b[i];
    sa += x;
    sb += y;
    saa += x * x;
    sbb += y * y;
    sab += x * y;
  }
  constexpr std::int64_t n = kPatchBytes;
  const double va = static_cast<double>(n * saa - sa * sa), vb = static_cast<double>(n * sbb - sb * sb);
  constexpr double kFlat = 4.0 * n * n;  // a standard deviation of two grey values is noise
  if (va < kFlat || vb < kFlat) return 0;
  return static_cast<double>(n * sab - sa * sb) / std::sqrt(va * vb);
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
