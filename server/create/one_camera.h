// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map/edit.h"

namespace coslam {

struct MapIntraConfig {
  int min_track_frames = 60;   // N_min: such tracks may become points with the parallax that any point needs
  int early_track_frames = 8;  // younger ones need the wider parallax: a fast camera never sees a point 60 frames long
  double early_parallax_rad = 0.035;
};

template <class V>
void describe(V& v, MapIntraConfig& c) {
  v.field("min_track_frames", c.min_track_frames, {2, 10000}, "N_min: such tracks may become points");
  v.field("early_track_frames", c.early_track_frames, {2, 10000},
          "shorter tracks down to this may too, with more parallax");
  v.field("early_parallax_rad", c.early_parallax_rad, {0, 1}, "of a track that is shorter than N_min");
}

struct MapIntraReport {
  int tried = 0, created = 0;

  void count(auto&& add) const { add("created_intra", created); }
};

// New static points from unmapped tracks of one camera (paper 5.2.1): from the widest parallax, gate theta in every
// frame.
MapIntraReport map_intra(MapEdit& edit, const FrameSet& set, const MapIntraConfig& config);

struct MapIntra {
  static constexpr std::string_view kName = "map_intra";
  using Config = MapIntraConfig;
  Config config;
  MapIntraReport run(MapEdit& edit, const FrameSet& set) const { return map_intra(edit, set, config); }
};

}  // namespace coslam
