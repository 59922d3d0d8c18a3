// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/cell_corners.h"

namespace coslam {
namespace {

// Vertex of the parabola through three values around a maximum, -0.5 to 0.5.
float peak_offset(float before, float at, float after) {
  const float curvature = before - 2 * at + after;
  return curvature < 0 ? std::clamp(0.5f * (before - after) / curvature, -0.5f, 0.5f) : 0.0f;
}

// Of equal neighbours exactly one is the maximum: strictly above those that come first.
bool is_maximum(const CornerScore& score, int x, int y) {
  const float* up = score.row(y - 1) + x;
  const float* row = score.row(y) + x;
  const float* down = score.row(y + 1) + x;
  const float s = row[0];
  return s > up[-1] && s > up[0] && s > up[1] && s > row[-1] && s >= row[1] && s >= down[-1] && s >= down[0] &&
         s >= down[1];
}

Eigen::Vector2f sub_pixel(const CornerScore& score, int x, int y) {
  const float s = score.row(y)[x];
  return {static_cast<float>(x) + peak_offset(score.row(y)[x - 1], s, score.row(y)[x + 1]),
          static_cast<float>(y) + peak_offset(score.row(y - 1)[x], s, score.row(y + 1)[x])};
}

}  // namespace

CellCorners corners_in(const CornerCell& cell, const PyramidLevel& level, CornerScore& score) {
  CellCorners out;
  const int cols = cell.x1 - cell.x0, rows = cell.y1 - cell.y0;
  if (cols <= 0 || rows <= 0) return out;
  const int x0 = cell.x0 - 1, y0 = cell.y0 - 1;  // a maximum needs its neighbours
  score.compute(level, x0, y0, cols + 2, rows + 2);
  float total = 0;
  for (int y = 1; y <= rows; ++y) {
    for (int x = 1; x <= cols; ++x) {
      const float s = score.row(y)[x];
      total += s;
      if (s < kLeastCornerScore || !is_maximum(score, x, y)) continue;
      const Eigen::Vector2f origin(static_cast<float>(x0), static_cast<float>(y0));
      out.corners.push_back({origin + sub_pixel(score, x, y), s});
    }
  }
  out.mean_score = total / static_cast<float>(cols * rows);
  std::stable_sort(out.corners.begin(), out.corners.end(),
                   [](const Corner& a, const Corner& b) { return a.score < b.score; });
  if (out.corners.size() > kMostCellCorners) {
    out.corners.erase(out.corners.begin(), out.corners.end() - kMostCellCorners);
  }
  return out;
}

}  // namespace coslam
