// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "agent/track/corner_score.h"
#include "agent/track/pyramid.h"

namespace coslam {

constexpr std::size_t kMostCellCorners = 12;
// Noise of 4 grey levels gives scores of 0.2 to 0.7 in the halved image.
constexpr float kLeastCornerScore = 0.3f;

// Corners are looked for in the image halved, where the noise of the camera makes none.
constexpr int corner_level(int levels) { return std::min(1, levels - 1); }

// A part of the level: pixels [x0, x1) x [y0, y1).
struct CornerCell {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct Corner {
  Eigen::Vector2f px;  // pixel of the level
  float score;         // (grey levels / pixel)^2
};

// The strongest corners of a cell, at most kMostCellCorners, strongest last.
struct CellCorners {
  std::vector<Corner> corners;
  float mean_score = 0;  // mean over all pixels of the cell
};

CellCorners corners_in(const CornerCell& cell, const PyramidLevel& level, CornerScore& score);

}  // namespace coslam
