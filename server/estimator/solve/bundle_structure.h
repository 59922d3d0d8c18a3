// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "server/estimator/solve/bundle.h"

namespace coslam {

// Structure of the problem, constant while it is solved: which pose sees which point. Columns stand for what is free,
// six parameters each: poses; then lenses, two columns each; then zooms, six poses of one camera in one column.
struct BundleStructure {
  static constexpr int kHalves = LensCorrection::kTerms / 6, kZooms = 6;
  // Column and point that share an observation.
  struct Link {
    int column, point;
  };
  std::vector<int> column_of;       // column of each pose; -1: fixed
  std::vector<int> lens_column_of;  // first column of each camera's lens; -1: the lens is given
  // Place of a pose's zoom; column -1: it has none.
  struct ZoomPlace {
    int column = -1, slot = 0;
  };
  std::vector<ZoomPlace> zoom_of;
  int columns = 0;
  std::vector<Eigen::Matrix2d> whiten;  // whitening of each observation, from undistorted px to standard deviations
  std::vector<Eigen::Vector2d> raw_px;  // each observation in the raw image, where there are lenses
  std::vector<int> link_of;             // link of each observation's pose; -1: the pose is fixed
  std::array<std::vector<int>, kHalves> lens_link_of;  // link of each observation's lens, for either half
  std::vector<int> zoom_link_of;                       // link of each observation's zoom
  std::vector<Link> links;                             // sorted by point, then by column
  std::vector<int> links_end;                          // one beyond the last link of each point
  std::vector<std::vector<int>> links_at;              // links of each column
  std::vector<std::vector<int>> rows_at;               // rows of each column's non-empty blocks, the diagonal first
};
BundleStructure structure_of(const BundleProblem& problem);

inline std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace coslam
