// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map/edit.h"

namespace coslam {

struct MapIntraConfig {
  int min_track_frames = 60;  // N_min: such tracks may become points with the parallax below
  double min_parallax_rad = 0.017;
  int early_track_frames = 8;  // younger ones need the wider parallax: a fast camera never sees a point 60 frames long
  double early_parallax_rad = 0.035;
  double max_relative_sigma = 0.3;  // sqrt(trace Sigma) over the distance
};

struct MapIntraReport {
  int tried = 0, created = 0;
};

// New static points from unmapped tracks of one camera (paper 5.2.1): from the widest parallax, gate theta in every
// frame.
MapIntraReport map_intra(MapEdit& edit, const FrameSet& set, const MapIntraConfig& config);

}  // namespace coslam
