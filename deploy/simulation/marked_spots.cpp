// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/marked_spots.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "deploy/simulation/noise.h"

namespace coslam::sim {
namespace {

using Eigen::Vector3d;

// The triangles of a body, by running sums of their areas.
class BodySurface {
 public:
  BodySurface(const SimulatedScene& scene, int body) : parts_(scene.parts()) {
    double area_m2 = 0;
    for (std::size_t part = scene.first_part(body); part < scene.first_part(body + 1); ++part) {
      for (std::size_t i = 0; i < parts_[part].triangles.size(); ++i) {
        area_m2 += 0.5 * edge(part, i, 1).cross(edge(part, i, 2)).norm();
        faces_.push_back({area_m2, part, i});
      }
    }
  }

  struct Place {
    std::size_t part = 0;
    Vector3d point, normal;  // frame of the part
  };
  Place draw(Random& random) const {
    const double at = random.uniform(0, faces_.back().up_to_m2);
    const auto face =
        std::lower_bound(faces_.begin(), faces_.end(), at, [](const Face& f, double x) { return f.up_to_m2 < x; });
    const double root = std::sqrt(random.uniform(0, 1)), along = random.uniform(0, 1);
    const Vector3d b = edge(face->part, face->triangle, 1), c = edge(face->part, face->triangle, 2);
    return {face->part, corner(face->part, face->triangle, 0) + root * ((1 - along) * b + along * c),
            b.cross(c).normalized()};
  }

 private:
  struct Face {
    double up_to_m2;
    std::size_t part, triangle;
  };
  Vector3d corner(std::size_t part, std::size_t triangle, std::size_t i) const {
    return parts_[part].vertices[parts_[part].triangles[triangle].corners[i]].point.cast<double>();
  }
  Vector3d edge(std::size_t part, std::size_t triangle, std::size_t i) const {
    return corner(part, triangle, i) - corner(part, triangle, 0);
  }

  const std::vector<Mesh>& parts_;
  std::vector<Face> faces_;
};

}  // namespace

std::vector<SurfaceSpot> marked_spots(const SimulatedScene& scene, int count, std::uint64_t seed) {
  constexpr double kLiftM = 0.03;
  std::vector<SurfaceSpot> out;
  const auto posed = scene.posed(0);
  Random random(mix(seed, 4242));
  for (int body = 0; body < scene.bodies(); ++body) {
    const BodySurface surface(scene, body);
    const auto until = static_cast<std::size_t>(count * (body + 1) / scene.bodies());
    for (int tries = 0; out.size() < until && tries < 100 * count; ++tries) {
      const auto place = surface.draw(random);
      const Rigid3& world_from_part = posed->world_from_part(place.part);
      const Vector3d normal = world_from_part.rotation * place.normal, point = world_from_part * place.point;
      // Parts reach into each other at the joints: what lies inside is no surface.
      const auto hit = scene.cast(point + kLiftM * normal, -normal, 0);
      const auto object = static_cast<std::uint32_t>(kFirstMovingObject + place.part);
      if (hit && hit->object == object && std::abs(hit->distance_m - kLiftM) < 1e-4)
        out.push_back({object, place.point});
    }
  }
  return out;
}

}  // namespace coslam::sim
