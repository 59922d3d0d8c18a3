// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "deploy/simulation/noise.h"
#include "deploy/simulation/world.h"

namespace coslam::sim {

// Place of a piece of furniture: the middle of its back, at its foot. Unturned it faces -y (its back towards +y);
// turn_deg is counter-clockwise seen from above.
struct Placement {
  double x_m = 0, y_m = 0, z_m = 0;
  double turn_deg = 0;
};

// Collects facets and lights. Thread-compatible.
class WorldBuilder {
 public:
  explicit WorldBuilder(std::uint64_t seed) : random_(seed) {}

  // Following facets belong to a new object; their local frame is the placement's (x right for who faces it, y back, z
  // up).
  void begin(const Placement& placement);
  // Material with a seed of its own.
  Material material(MaterialKind kind, double tone);

  Facet& rect(const Eigen::Vector3d& upper_left, const Eigen::Vector3d& edge_u, const Eigen::Vector3d& edge_v,
              const Material& m);
  // An axis-parallel box; its front (towards -y) in `front`, the rest in `skin`.
  void box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const Material& skin, const Material& front);
  void box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const Material& skin) {
    box(low, high, skin, skin);
  }
  // An upright prism with a top.
  void cylinder(const Eigen::Vector3d& foot, double radius_m, double height_m, int sides, const Material& m);
  // A lamp below a ceiling that shines down from a rectangle around `middle`.
  void ceiling_lamp(const Eigen::Vector3d& middle, double size_x_m, double size_y_m, double radiance);
  // A light without a visible surface.
  void light(const Eigen::Vector3d& corner, const Eigen::Vector3d& edge_u, const Eigen::Vector3d& edge_v,
             double radiance);

  Random& random() { return random_; }
  World& world() { return world_; }

 private:
  Random random_;
  World world_;
  Eigen::Isometry3d world_from_local_ = Eigen::Isometry3d::Identity();
  std::uint32_t object_ = 0;
};

}  // namespace coslam::sim
