// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "deploy/coslam/plot/top_view.h"

namespace coslam::plot {

// Orthogonal view on a plane, in units of the world.
struct Projection {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 2, 3> axes = Eigen::Matrix<double, 2, 3>::Identity();    // to the right, upwards
  Eigen::Vector2d min = Eigen::Vector2d::Zero(), max = Eigen::Vector2d::Zero();  // area that should be seen

  Eigen::Vector2d operator()(const Eigen::Vector3d& p) const { return axes * (p - center); }
};

Projection widest_plane(const TopView& view);

}  // namespace coslam::plot
