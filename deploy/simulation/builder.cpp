// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/builder.h"

#include <cmath>
#include <numbers>

#include "common/base/check.h"

namespace coslam::sim {

void WorldBuilder::begin(const Placement& placement) {
  ++object_;
  COSLAM_CHECK(object_ < kFirstMovingObject, "too many objects in a world");
  world_from_local_ = Eigen::Translation3d(placement.x_m, placement.y_m, placement.z_m) *
                      Eigen::AngleAxisd(placement.turn_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitZ());
}

Material WorldBuilder::material(MaterialKind kind, double tone) {
  return {kind, static_cast<std::uint32_t>(random_.next() >> 32), static_cast<float>(tone)};
}

Facet& WorldBuilder::rect(const Eigen::Vector3d& upper_left, const Eigen::Vector3d& edge_u,
                          const Eigen::Vector3d& edge_v, const Material& m) {
  Facet facet;
  facet.origin = world_from_local_ * upper_left;
  facet.edge_u = world_from_local_.linear() * edge_u;
  facet.edge_v = world_from_local_.linear() * edge_v;
  facet.normal = facet.edge_v.cross(facet.edge_u).normalized();
  facet.material = m;
  facet.object = object_;
  world_.facets.push_back(facet);
  return world_.facets.back();
}

void WorldBuilder::box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const Material& skin,
                       const Material& front) {
  const Eigen::Vector3d size = high - low;
  const Eigen::Vector3d x(size.x(), 0, 0), y(0, size.y(), 0), down(0, 0, -size.z());
  // Faces of one material show different parts of it.
  const auto face = [&](const Eigen::Vector3d& corner, const Eigen::Vector3d& u, const Eigen::Vector3d& v,
                        const Material& m) {
    Facet& facet = rect(corner, u, v, m);
    facet.material.seed += static_cast<std::uint32_t>(world_.facets.size());
  };
  rect({low.x(), low.y(), high.z()}, x, down, front);
  face({high.x(), high.y(), high.z()}, -x, down, skin);
  face({low.x(), high.y(), high.z()}, -y, down, skin);
  face({high.x(), low.y(), high.z()}, y, down, skin);
  face({low.x(), high.y(), high.z()}, x, -y, skin);
  face({low.x(), low.y(), low.z()}, x, y, skin);
}

void WorldBuilder::cylinder(const Eigen::Vector3d& foot, double radius_m, double height_m, int sides,
                            const Material& m) {
  const double step = 2.0 * std::numbers::pi / sides;
  const auto rim = [&](double angle) {
    return Eigen::Vector3d(foot.x() + radius_m * std::cos(angle), foot.y() + radius_m * std::sin(angle),
                           foot.z() + height_m);
  };
  for (int i = 0; i < sides; ++i) {
    const Eigen::Vector3d a = rim(i * step), b = rim((i + 1) * step);
    Facet& facet = rect(a, b - a, {0, 0, -height_m}, m);
    facet.offset_u_m = i * (b - a).norm();
  }
  // The top as slats, each as wide as the circle is there.
  constexpr int kSlats = 8;
  for (int i = 0; i < kSlats; ++i) {
    const double y = radius_m * (2.0 * (i + 0.5) / kSlats - 1.0), half = std::sqrt(radius_m * radius_m - y * y);
    const double depth = 2.0 * radius_m / kSlats;
    Facet& facet =
        rect({foot.x() - half, foot.y() + y + depth / 2, foot.z() + height_m}, {2 * half, 0, 0}, {0, -depth, 0}, m);
    facet.offset_u_m = -half;
    facet.offset_v_m = -y;
  }
}

void WorldBuilder::light(const Eigen::Vector3d& corner, const Eigen::Vector3d& edge_u, const Eigen::Vector3d& edge_v,
                         double radiance) {
  RectLight out;
  out.corner = world_from_local_ * corner;
  out.edge_u = world_from_local_.linear() * edge_u;
  out.edge_v = world_from_local_.linear() * edge_v;
  out.normal = out.edge_v.cross(out.edge_u).normalized();
  out.radiance = radiance;
  world_.lights.push_back(out);
}

void WorldBuilder::ceiling_lamp(const Eigen::Vector3d& middle, double size_x_m, double size_y_m, double radiance) {
  constexpr double kThicknessM = 0.06, kVisibleRadiance = 3.0;
  const Eigen::Vector3d half(size_x_m / 2, size_y_m / 2, kThicknessM / 2);
  box(middle - half, middle + half, material(MaterialKind::kPaint, 0.6));
  const Eigen::Vector3d corner = middle + Eigen::Vector3d(-half.x(), -half.y(), -half.z() - 0.002);
  Facet& shade = rect(corner, {size_x_m, 0, 0}, {0, size_y_m, 0}, material(MaterialKind::kLamp, 0.5));
  shade.emission = kVisibleRadiance;
  light(corner - Eigen::Vector3d(0, 0, 0.002), {size_x_m, 0, 0}, {0, size_y_m, 0}, radiance);
}

}  // namespace coslam::sim
