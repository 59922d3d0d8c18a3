// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "deploy/simulation/caster.h"
#include "deploy/simulation/world.h"

namespace coslam::sim {

// The light that falls on a facet, on a coarse grid: soft shadows of the rectangular lights, and ambient light where
// nothing stands close by. The radiance of a Lambertian surface is its albedo times this.
class LightMap {
 public:
  LightMap(const World& world, const Caster& caster, const Facet& facet, double cell_m);
  // u, v in [0, 1] along the facet's edges.
  float at(float u, float v) const;

 private:
  void smooth();

  int columns_ = 0, rows_ = 0;
  std::vector<float> cells_;
};

// Light on an unshaded place, with an upright share of the ambient light. For things that move.
double unshaded_light(const World& world, const Eigen::Vector3d& point, const Eigen::Vector3d& normal);

}  // namespace coslam::sim
