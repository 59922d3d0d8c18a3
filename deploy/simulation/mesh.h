// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/rigid3.h"
#include "deploy/simulation/material.h"

namespace coslam::sim {

// A textured rectangle that is wrapped around a part.
struct Skin {
  Material material;
  double width_m = 0, height_m = 0;
  double texel_m = 0.0025;
};

struct MeshVertex {
  Eigen::Vector3f point = Eigen::Vector3f::Zero();   // frame of the part, metres
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // unit, outwards
  Eigen::Vector2f uv = Eigen::Vector2f::Zero();      // in the skin, [0, 1]
};

struct MeshTriangle {
  std::array<std::uint32_t, 3> corners{};
  std::uint32_t skin = 0;
};

// The surface of a rigid thing, in its own frame.
struct Mesh {
  std::vector<MeshVertex> vertices;
  std::vector<MeshTriangle> triangles;
  std::vector<Skin> skins;
};

// A cut through a loft, across its z axis: half lengths, and where the middle lies.
struct Section {
  double z_m = 0;
  double half_x_m = 0, half_y_m = 0;
  double middle_x_m = 0, middle_y_m = 0;
};

struct LoftShape {
  std::vector<Section> sections;               // ascending z, at least two; smooth in between
  double low_cap_m = 0.02, high_cap_m = 0.02;  // over which lengths the ends are rounded off
  double roundness = 2;                        // exponent of the cuts: 2 is an ellipse, more is squarer
};

// Adds a closed tube to the mesh. The skin goes around z once from +x over +y, and from the high end down to the low
// one.
void add_loft(Mesh& mesh, const Rigid3& part_from_loft, const LoftShape& shape, const Material& material);
// Adds a box; `front` is the side of +x, `skin` the others.
void add_box(Mesh& mesh, const Rigid3& part_from_box, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
             const Material& skin, const Material& front);

}  // namespace coslam::sim
