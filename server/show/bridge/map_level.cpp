// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/bridge/map_level.h"

#include <cmath>

namespace coslam {

Eigen::Quaterniond frd_from_map(const MapLevel& level) {
  constexpr double kSteep = 0.95;
  Eigen::Vector3d down(level.down_x, level.down_y, level.down_z);
  if (down.norm() < 1e-6) down = Eigen::Vector3d::UnitY();
  down.normalize();
  Eigen::Vector3d ahead = Eigen::Vector3d::UnitZ();
  if (std::abs(down.z()) > kSteep) ahead = -Eigen::Vector3d::UnitY();
  ahead = (ahead - ahead.dot(down) * down).normalized();
  Eigen::Matrix3d r;
  r << ahead.transpose(), down.cross(ahead).transpose(), down.transpose();
  return Eigen::Quaterniond(r);
}

Eigen::Quaterniond flu_from_map(const MapLevel& level) {
  return Eigen::Quaterniond(0, 1, 0, 0) * frd_from_map(level);  // half a turn about ahead
}

}  // namespace coslam
