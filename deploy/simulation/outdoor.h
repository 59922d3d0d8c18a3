// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "deploy/simulation/furniture.h"

// Things that stand outside. Their textures and light maps are for things that are seen from farther away than in a
// room. Lengths in metres.
namespace coslam::sim {

inline constexpr double kWallTexelM = 0.006, kGroundTexelM = 0.009, kWallLightM = 0.12;

// Facets added since `first` get these textures and light maps.
void coarsen(WorldBuilder& b, std::size_t first, double texel_m, double light_cell_m);

void add_coarse_block(WorldBuilder& b, const Placement& at, const Eigen::Vector3d& size_m, MaterialKind kind,
                      double tone);
// Trees and sky all around, at these distances from the origin along x and y, and the sky above.
void add_horizon(WorldBuilder& b, double far_x_m, double far_y_m, double sky_m = 24);
// A small far light whose light has the strength `sunlight` on a surface that faces it from the origin.
void add_sun(WorldBuilder& b, const Eigen::Vector3d& from, double sunlight);
// A pane in a frame on a house wall.
void add_house_window(WorldBuilder& b, const Placement& at, double width_m, double height_m);
void add_tree(WorldBuilder& b, double x_m, double y_m, double radius_m);
// A board on two posts with a print over all its front.
void add_sign_board(WorldBuilder& b, const Placement& at, double width_m, double height_m);

// Windows, prints, pilasters and boards on it from one place to another, plants, boxes and benches at its foot.
void furnish_front(WorldBuilder& b, const WallFront& wall, double from_m, double to_m);

}  // namespace coslam::sim
