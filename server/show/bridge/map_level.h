// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

namespace coslam {

// Direction of gravity in the map. A map has the axes of its first camera, x right, y down, z ahead, so the default is
// right when that camera was level.
struct MapLevel {
  double down_x = 0, down_y = 1, down_z = 0;  // down in the axes of the map, of any length
};

template <class V>
void describe(V& v, MapLevel& c) {
  v.field("down_x", c.down_x, {-1, 1},
          "down in the axes of the map, which are those of its first camera at the start:");
  v.field("down_y", c.down_y, {-1, 1}, "x right, y down, z ahead; 0 1 0 when that was level");
  v.field("down_z", c.down_z, {-1, 1}, "the same");
}

// Rotation to axes that point ahead (the map's z, or its -y when that camera looked down), right and down.
Eigen::Quaterniond frd_from_map(const MapLevel& level);
// Rotation to axes that point ahead, left and up, as REP 103 has them.
Eigen::Quaterniond flu_from_map(const MapLevel& level);

}  // namespace coslam
