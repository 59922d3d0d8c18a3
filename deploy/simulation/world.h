// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "deploy/simulation/material.h"

namespace coslam::sim {

// Ids from here on are kept for things that move.
inline constexpr std::uint32_t kFirstMovingObject = 100000;

// A textured parallelogram, seen from both sides. Seen from its front, edge_u runs to the right and edge_v down.
struct Facet {
  Eigen::Vector3d origin, edge_u, edge_v;  // upper left corner; world, metres
  Eigen::Vector3d normal;                  // unit, out of the front
  Material material;
  double offset_u_m = 0, offset_v_m = 0;  // position of the facet in its material
  double texel_m = 0.003;
  double light_cell_m = 0.04;  // cell of its light map
  float emission = 0;          // radiance of its own
  std::uint32_t object = 0;

  double width_m() const { return edge_u.norm(); }
  double height_m() const { return edge_v.norm(); }
};

// A rectangle that shines out of its front.
struct RectLight {
  Eigen::Vector3d corner, edge_u, edge_v;
  Eigen::Vector3d normal;
  double radiance = 1;
};

struct World {
  std::vector<Facet> facets;
  std::vector<RectLight> lights;
  double ambient = 0.3;  // radiance that comes from everywhere that is open
};

}  // namespace coslam::sim
