// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/lighting.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "deploy/simulation/noise.h"

namespace coslam::sim {
namespace {

using Eigen::Vector3d;

constexpr int kLightGrid = 4;    // shadow rays to a light: a jittered grid over it
constexpr int kAmbientGrid = 4;  // directions over the hemisphere
constexpr double kAmbientReachM = 1.5;
constexpr double kLiftM = 1e-3;

// Jittered places in the cells of an n x n grid over the unit square.
template <class Visit>
void for_stratified(int n, std::uint32_t key, const Visit& visit) {
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const std::uint32_t h = hash_cell(i, j, key);
      visit((i + static_cast<double>(unit(h))) / n, (j + static_cast<double>(unit(h * 3U + 1U))) / n);
    }
  }
}

double from_light(const RectLight& light, const Caster& caster, const Vector3d& p, const Vector3d& normal,
                  std::uint32_t key) {
  const double area_m2 = light.edge_u.cross(light.edge_v).norm();
  double sum = 0;
  for_stratified(kLightGrid, key, [&](double a, double b) {
    const Vector3d target = light.corner + a * light.edge_u + b * light.edge_v;
    const Vector3d way = target - p;
    const double squared = std::max(way.squaredNorm(), 0.01), length = std::sqrt(squared);
    const double at_surface = normal.dot(way) / length, at_light = -light.normal.dot(way) / length;
    if (at_surface <= 0 || at_light <= 0 || caster.blocked(p, target)) return;
    sum += at_surface * at_light / squared;
  });
  return light.radiance * area_m2 * sum / (kLightGrid * kLightGrid * std::numbers::pi);
}

// Share of the hemisphere, weighted by the cosine, that is open within the reach.
double openness(const Caster& caster, const Vector3d& p, const Vector3d& normal, std::uint32_t key) {
  const Vector3d tangent = normal.unitOrthogonal(), other = normal.cross(tangent);
  int open = 0;
  for_stratified(kAmbientGrid, key, [&](double a, double b) {
    const double radius = std::sqrt(a), angle = 2 * std::numbers::pi * b;
    const Vector3d way =
        radius * std::cos(angle) * tangent + radius * std::sin(angle) * other + std::sqrt(1 - a) * normal;
    if (!caster.blocked(p, p + kAmbientReachM * way)) ++open;
  });
  return static_cast<double>(open) / (kAmbientGrid * kAmbientGrid);
}

}  // namespace

LightMap::LightMap(const World& world, const Caster& caster, const Facet& facet, double cell_m)
    : columns_(std::max(2, static_cast<int>(std::ceil(facet.width_m() / cell_m)))),
      rows_(std::max(2, static_cast<int>(std::ceil(facet.height_m() / cell_m)))) {
  cells_.reserve(static_cast<std::size_t>(columns_ * rows_));
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const Vector3d p = facet.origin + facet.edge_u * ((column + 0.5) / columns_) +
                         facet.edge_v * ((row + 0.5) / rows_) + kLiftM * facet.normal;
      std::uint32_t key = hash_cell(column, row, facet.material.seed);
      double sum = world.ambient * openness(caster, p, facet.normal, key);
      for (const RectLight& light : world.lights) sum += from_light(light, caster, p, facet.normal, ++key);
      cells_.push_back(static_cast<float>(sum));
    }
  }
  smooth();
}

void LightMap::smooth() {
  // Takes the grain of the few rays a cell away; shadows stay soft to about two cells.
  const std::vector<float> from = cells_;
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      float sum = 0, weights = 0;
      for (int j = std::max(0, row - 1); j <= std::min(rows_ - 1, row + 1); ++j) {
        for (int i = std::max(0, column - 1); i <= std::min(columns_ - 1, column + 1); ++i) {
          const float weight = (i == column ? 2.0F : 1.0F) * (j == row ? 2.0F : 1.0F);
          sum += weight * from[static_cast<std::size_t>(j * columns_ + i)];
          weights += weight;
        }
      }
      cells_[static_cast<std::size_t>(row * columns_ + column)] = sum / weights;
    }
  }
}

float LightMap::at(float u, float v) const {
  const float x = std::clamp(u * static_cast<float>(columns_) - 0.5F, 0.0F, static_cast<float>(columns_ - 1));
  const float y = std::clamp(v * static_cast<float>(rows_) - 0.5F, 0.0F, static_cast<float>(rows_ - 1));
  const int x0 = std::min(static_cast<int>(x), columns_ - 2), y0 = std::min(static_cast<int>(y), rows_ - 2);
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const float* p = cells_.data() + static_cast<std::size_t>(y0 * columns_ + x0);
  const float top = p[0] + fx * (p[1] - p[0]), bottom = p[columns_] + fx * (p[columns_ + 1] - p[columns_]);
  return top + fy * (bottom - top);
}

double unshaded_light(const World& world, const Vector3d& point, const Vector3d& normal) {
  constexpr double kPlaces[] = {0.25, 0.75};  // along each edge of a light
  constexpr double kFromBelow = 0.45;
  double sum = world.ambient * (kFromBelow + (1 - kFromBelow) * 0.5 * (1 + normal.z()));
  for (const RectLight& light : world.lights) {
    const double area_m2 = light.edge_u.cross(light.edge_v).norm();
    double seen = 0;
    for (const double u : kPlaces) {
      for (const double v : kPlaces) {
        const Vector3d way = light.corner + u * light.edge_u + v * light.edge_v - point;
        const double squared = std::max(way.squaredNorm(), 0.01), length = std::sqrt(squared);
        seen += std::max(0.0, normal.dot(way) / length) * std::max(0.0, -light.normal.dot(way) / length) / squared;
      }
    }
    sum += light.radiance * area_m2 * seen / (4 * std::numbers::pi);
  }
  return sum;
}

}  // namespace coslam::sim
