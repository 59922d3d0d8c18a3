// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "server/map/map.h"

namespace coslam {

struct ViewEdge {
  CameraId first, second;
  int shared = 0;  // N_ij: map points that both observe now
};

struct ViewGraph {
  std::vector<ViewEdge> edges;                // N_ij > 0
  std::vector<ViewEdge> tree;                 // maximum-weight spanning forest
  std::vector<std::vector<CameraId>> groups;  // connected components, ascending
};

// Cameras by shared view (paper 6.1).
ViewGraph view_graph(const Map& map, const FrameSet& set);

}  // namespace coslam
