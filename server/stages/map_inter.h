// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map/edit.h"
#include "server/stages/group.h"

namespace coslam {

struct MapInterConfig {
  int period = 5;         // frame sets between runs
  int moving_period = 2;  // the same for moving points
  double zncc_min = 0.7;
  double zncc_margin = 0.05;    // best over second best
  double seed_radius = 0.10;    // phi_r, of the larger image side
  double disparity_gate = 3.0;  // phi_d over phi_r
  double min_parallax_rad = 0.017;
  double max_relative_sigma = 0.3;  // sqrt(trace Sigma) over the distance
  int check_back = 30;              // earlier frames in which the static point must fit both tracks
  int moving_check_back = 10;       // instants at which two tracks of a moving thing must have met
};

struct MapInterReport {
  int compared = 0, matched = 0;
  int created = 0;  // static points
  int moving = 0;   // pairs of tracks joined in a moving point
};

// New static points from unmapped tracks of two cameras that share an edge of the spanning tree (paper 5.2.2): epipolar
// band, patch correlation, disparity like that of the nearest shared point, mutual best; then the gate in both, now and
// back in time.
MapInterReport map_inter(MapEdit& edit, const FrameSet& set, const ViewGraph& graph, const MapInterConfig& config);

}  // namespace coslam
