// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "server/estimator/map/lens_pen.h"

namespace coslam {

// Verbs on maps as wholes, and on their key frames.
class MapsPen : public LensPen {
 protected:
  using LensPen::LensPen;

  MapId new_map(Why why, double figure);
  // Makes a set, now or earlier, a key frame: tracks bound now give their observations of it, except those of spared
  // cameras. Does nothing if it is one already.
  void add_key_frame(SetId set, const std::vector<CameraId>& spared = {});
  // Makes one camera's image a key image: points keep their observations of it too.
  void add_key_image(SetId set, CameraId camera);
  // Merges `from` into `into`: cameras, points and every earlier pose are transformed by into_from_from.
  void merge(MapId from, MapId into, const Similarity3& into_from_from);
  // Transforms a whole map, for example to a known scale.
  void transform(MapId map, const Similarity3& new_from_old, Why why);
  // Marks the lengths of that map as metres.
  void set_metric(MapId map) { map_.metric_.insert(map); }
  // Raises the epoch: the map moved under the agents.
  void raise_epoch() { ++map_.epoch_.value; }
  void note_moved(MapId map, Why why, Figures figures);

 private:
  void move_map(MapId map, const Similarity3& new_from_old);
};

}  // namespace coslam
