// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map/edit.h"

namespace coslam {

struct RegisterConfig {
  double zncc_min = 0.7;
  int check_back = 60;       // frames of the track in which the gate must hold
  int min_track_frames = 4;  // younger tracks wait
};

struct RegisterReport {
  int candidates = 0, registered = 0;
};

// Unmapped tracks of each camera against active static points (paper 5.3): smallest Mahalanobis distance (8) within
// theta, patch correlation, and the gate at every frame of the track. The point is then triangulated anew from its
// widest views.
RegisterReport register_tracks(MapEdit& edit, const FrameSet& set, const RegisterConfig& config);

// Position and covariance of a point from all its key views and the newest view of each bound track.
// False when its views do not determine it (it then stays as it is).
bool retriangulate(MapEdit& edit, const MapPoint& point);

}  // namespace coslam
