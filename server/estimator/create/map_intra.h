// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/map/keys.h"
#include "server/estimator/pose/window_pose.h"

namespace coslam {

struct MapIntraConfig {
  // Least parallax of younger tracks: one that follows a moving thing for a moment seems to have some.
  double early_parallax_rad = 0.035;
  double early_track_s = 0.27;  // least age of a track
};

template <class V>
void describe(V& v, MapIntraConfig& c) {
  v.field("early_parallax_rad", c.early_parallax_rad, {0, 1}, "of a track that is shorter than check_back_s");
  v.field("early_track_s", c.early_track_s, {0.01, 100}, "younger tracks do not become points");
}

struct MapIntraReport {
  int tried = 0, created = 0;

  void count(auto&& add) const { add("created_intra", created); }
};

// Creates static points from unmapped tracks of one camera (paper 5.2.1): from the widest parallax, gate theta in every
// frame. If the camera's poses were solved by a window (window_pose.h), young tracks need more parallax the more it
// turned.
MapIntraReport map_intra(MapIntraEdit& edit, const FrameSet& set, const WindowPoseReport& windows,
                         const MapIntraConfig& config);

struct MapIntra {
  static constexpr std::string_view kName = "map_intra";
  using Config = MapIntraConfig;
  Config config;
  MapIntraReport run(MapIntraEdit& edit, const FrameSet& set, const WindowPoseReport& windows) const {
    return map_intra(edit, set, windows, config);
  }
};

}  // namespace coslam
