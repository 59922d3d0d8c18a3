// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map/edit.h"

namespace coslam {

struct RegisterConfig {
  double check_back_s = 2.0;  // of the track, in which the gate must hold
};

template <class V>
void describe(V& v, RegisterConfig& c) {
  v.field("check_back_s", c.check_back_s, {0.1, 100}, "of a track, in which the gate must hold");
}

struct RegisterReport {
  int candidates = 0, registered = 0;

  void count(auto&& add) const {
    add("register_candidates", candidates);
    add("registered", registered);
  }
};

// Unmapped tracks of each camera against active static points (paper 5.3): smallest Mahalanobis distance (8) within
// theta, patch correlation, and the gate at every frame of the track. The point is then triangulated anew from its
// widest views.
RegisterReport register_tracks(MapEdit& edit, const FrameSet& set, const RegisterConfig& config);

// Position and covariance of a point from all its key views and the newest view of each bound track.
// False when its views do not determine it (it then stays as it is).
bool retriangulate(MapEdit& edit, const MapPoint& point);

struct Register {
  static constexpr std::string_view kName = "register";
  using Config = RegisterConfig;
  Config config;
  RegisterReport run(MapEdit& edit, const FrameSet& set) const { return register_tracks(edit, set, config); }
};

}  // namespace coslam
