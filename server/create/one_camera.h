// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map/edit.h"

namespace coslam {

struct MapIntraConfig {
  double min_track_s = 2.0;     // N_min: so long tracks may become points with the parallax that any point needs
  double early_track_s = 0.27;  // shorter ones need the wider parallax: a fast camera sees nothing for 2 s
  double early_parallax_rad = 0.035;
};

template <class V>
void describe(V& v, MapIntraConfig& c) {
  v.field("min_track_s", c.min_track_s, {0.01, 100}, "N_min: tracks so long may become points");
  v.field("early_track_s", c.early_track_s, {0.01, 100}, "shorter tracks down to this may too, with more parallax");
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
