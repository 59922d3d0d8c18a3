// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/check.h"

namespace coslam::sim {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kSectors = 18, kCapRings = 4;
constexpr double kRingM = 0.035;
constexpr float kLeastAreaM2 = 1e-9F;

double catmull_rom(double a, double b, double c, double d, double s) {
  return b + 0.5 * s * (c - a + s * (2 * a - 5 * b + 4 * c - d + s * (3 * (b - c) + d - a)));
}

Section section_at(const std::vector<Section>& all, double z_m) {
  const auto last = all.size() - 1;
  std::size_t i = 0;
  while (i + 2 < all.size() && all[i + 1].z_m < z_m) ++i;
  const Section &b = all[i], &c = all[i + 1], &a = all[i == 0 ? 0 : i - 1], &d = all[std::min(i + 2, last)];
  const double s = std::clamp((z_m - b.z_m) / (c.z_m - b.z_m), 0.0, 1.0);
  const auto mixed = [&](double Section::*m) { return catmull_rom(a.*m, b.*m, c.*m, d.*m, s); };
  return {z_m, mixed(&Section::half_x_m), mixed(&Section::half_y_m), mixed(&Section::middle_x_m),
          mixed(&Section::middle_y_m)};
}

// The cuts that become rings of vertices, from the high end down; those at the ends shrink to a point.
std::vector<Section> rings_of(const LoftShape& shape) {
  const double low = shape.sections.front().z_m, high = shape.sections.back().z_m;
  std::vector<Section> out;
  const auto add = [&](double z_m, double share) {
    Section ring = section_at(shape.sections, z_m);
    ring.half_x_m *= share;
    ring.half_y_m *= share;
    out.push_back(ring);
  };
  for (int i = 0; i <= kCapRings; ++i) {
    const double angle = 0.5 * std::numbers::pi * i / kCapRings;
    add(high - shape.high_cap_m * (1 - std::cos(angle)), std::sin(angle));
  }
  const double top = high - shape.high_cap_m, bottom = low + shape.low_cap_m;
  const int steps = std::max(1, static_cast<int>(std::lround((top - bottom) / kRingM)));
  for (int i = 1; i < steps; ++i) add(top + (bottom - top) * i / steps, 1);
  for (int i = kCapRings; i >= 0; --i) {
    const double angle = 0.5 * std::numbers::pi * i / kCapRings;
    add(low + shape.low_cap_m * (1 - std::cos(angle)), std::sin(angle));
  }
  return out;
}

double powered(double x, double exponent) { return std::copysign(std::pow(std::abs(x), exponent), x); }

void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t skin) {
  const Vector3f &pa = mesh.vertices[a].point, &pb = mesh.vertices[b].point, &pc = mesh.vertices[c].point;
  if ((pb - pa).cross(pc - pa).norm() > kLeastAreaM2) mesh.triangles.push_back({{a, b, c}, skin});
}

// Normals as the mean of the faces around, the two sides of the seam together.
void smooth_normals(Mesh& mesh, std::size_t first_vertex, std::size_t first_triangle, int rings) {
  for (std::size_t i = first_triangle; i < mesh.triangles.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i].corners;
    const Vector3f& origin = mesh.vertices[a].point;
    const Vector3f normal = (mesh.vertices[b].point - origin).cross(mesh.vertices[c].point - origin);
    for (const std::uint32_t corner : {a, b, c}) mesh.vertices[corner].normal += normal;
  }
  constexpr std::size_t kRow = kSectors + 1;
  for (std::size_t ring = 0; ring < static_cast<std::size_t>(rings); ++ring) {
    MeshVertex* row = mesh.vertices.data() + first_vertex + ring * kRow;
    row[0].normal += row[kSectors].normal;
    row[kSectors].normal = row[0].normal;
    if (ring == 0 || ring + 1 == static_cast<std::size_t>(rings)) {  // a pole
      Vector3f sum = Vector3f::Zero();
      for (std::size_t i = 0; i < kRow; ++i) sum += row[i].normal;
      for (std::size_t i = 0; i < kRow; ++i) row[i].normal = sum;
    }
    for (std::size_t i = 0; i < kRow; ++i) row[i].normal.normalize();
  }
}

}  // namespace

void add_loft(Mesh& mesh, const Rigid3& part_from_loft, const LoftShape& shape, const Material& material) {
  COSLAM_CHECK(shape.sections.size() >= 2, "a loft needs two sections");
  const std::vector<Section> rings = rings_of(shape);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size()),
             skin = static_cast<std::uint32_t>(mesh.skins.size());
  const std::size_t first_triangle = mesh.triangles.size();
  Skin cover{material, 0, 0};
  for (const Section& ring : rings) {
    double around_m = 0, down_m = 0;
    for (int i = 0; i <= kSectors; ++i) {
      const double angle = 2 * std::numbers::pi * (i % kSectors) / kSectors;
      const double x = powered(std::cos(angle), 2 / shape.roundness), y = powered(std::sin(angle), 2 / shape.roundness);
      MeshVertex vertex;
      vertex.point = (part_from_loft *
                      Vector3d(ring.middle_x_m + ring.half_x_m * x, ring.middle_y_m + ring.half_y_m * y, ring.z_m))
                         .cast<float>();
      vertex.normal = Vector3f::Zero();
      vertex.uv = {static_cast<float>(i) / kSectors, 0};
      if (i > 0) around_m += (vertex.point - mesh.vertices.back().point).norm();
      const std::size_t above = mesh.vertices.size() - (kSectors + 1);
      if (mesh.vertices.size() >= first + (kSectors + 1U)) {
        down_m = std::max<double>(down_m, (vertex.point - mesh.vertices[above].point).norm());
      }
      mesh.vertices.push_back(vertex);
    }
    cover.height_m += down_m;
    cover.width_m = std::max(cover.width_m, around_m);
    for (auto v = mesh.vertices.end() - (kSectors + 1); v != mesh.vertices.end(); ++v) {
      v->uv.y() = static_cast<float>(cover.height_m);
    }
  }
  for (auto v = mesh.vertices.begin() + first; v != mesh.vertices.end(); ++v) {
    v->uv.y() /= static_cast<float>(cover.height_m);
  }
  for (std::uint32_t ring = 0; ring + 1 < rings.size(); ++ring) {
    for (std::uint32_t i = 0; i < kSectors; ++i) {
      const std::uint32_t a = first + ring * (kSectors + 1) + i, below = a + kSectors + 1;
      add_triangle(mesh, a, below, a + 1, skin);
      add_triangle(mesh, a + 1, below, below + 1, skin);
    }
  }
  mesh.skins.push_back(cover);
  smooth_normals(mesh, first, first_triangle, static_cast<int>(rings.size()));
}

void add_box(Mesh& mesh, const Rigid3& part_from_box, const Vector3d& low, const Vector3d& high, const Material& skin,
             const Material& front) {
  const auto face = [&](const Vector3d& corner, const Vector3d& u, const Vector3d& v, Material material) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size()),
               index = static_cast<std::uint32_t>(mesh.skins.size());
    material.seed += index;  // faces of one material show different parts of it
    mesh.skins.push_back({material, u.norm(), v.norm()});
    const Vector3f normal = (part_from_box.rotation * v.cross(u).normalized()).cast<float>();
    for (const auto& [a, b] : {std::pair(0.0, 0.0), {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
      mesh.vertices.push_back({(part_from_box * (corner + a * u + b * v)).cast<float>(),
                               normal,
                               {static_cast<float>(a), static_cast<float>(b)}});
    }
    add_triangle(mesh, first, first + 3, first + 1, index);
    add_triangle(mesh, first + 1, first + 3, first + 2, index);
  };
  const Vector3d size = high - low;
  const Vector3d x(size.x(), 0, 0), y(0, size.y(), 0), down(0, 0, -size.z());
  face({high.x(), low.y(), high.z()}, y, down, front);
  face({low.x(), high.y(), high.z()}, -y, down, skin);
  face({low.x(), low.y(), high.z()}, x, down, skin);
  face({high.x(), high.y(), high.z()}, -x, down, skin);
  face({low.x(), high.y(), high.z()}, x, -y, skin);
  face({low.x(), low.y(), low.z()}, x, y, skin);
}

}  // namespace coslam::sim
