// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "deploy/simulation/lighting.h"
#include "deploy/simulation/parallel.h"
#include "deploy/simulation/scene.h"

namespace coslam::sim {
namespace {

// Eight queens: as many distinct places in x and in y as there are rays, so that upright and level edges move smoothly.
constexpr std::array<int, RayTable::kRays> kRayRow{3, 6, 1, 4, 7, 2, 5, 0};
// What one of the rays reads: enough to leave no gap to its neighbours across the pixel, and along a slanted surface.
constexpr float kShareAcross = 0.5F, kShareAlong = 0.25F;
constexpr int kMaxTexels = 8192;

Eigen::Vector2f ray_through(const CameraModel& camera, double x, double y) {
  const auto undistorted_px = camera.undistorted_from_raw({x, y});
  if (!undistorted_px) return Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN());
  return camera.normalized_from_pixel(*undistorted_px).cast<float>();
}

}  // namespace

RayTable::RayTable(const CameraModel& camera, int threads)
    : width_(camera.width_px), height_(camera.height_px), focal_px_(camera.focal_px()) {
  const auto pixels = static_cast<std::size_t>(width_ * height_);
  rays_.resize(pixels * kRays);
  central_.resize(pixels);
  parallel_for(height_, threads, [&](int y) {
    for (int x = 0; x < width_; ++x) {
      central_[index(x, y)] = ray_through(camera, x, y);
      for (std::size_t k = 0; k < kRays; ++k) {
        const double dx = (static_cast<double>(k) + 0.5) / kRays - 0.5, dy = (kRayRow[k] + 0.5) / kRays - 0.5;
        rays_[index(x, y) * kRays + k] = ray_through(camera, x + dx, y + dy);
      }
    }
  });
}

Renderer::Renderer(const World& world, const Caster& caster, int threads, double coarseness)
    : world_(world), caster_(caster), surfaces_(world.facets.size()) {
  // Large ones first, so that the threads end together.
  std::vector<int> order(world.facets.size());
  std::iota(order.begin(), order.end(), 0);
  const auto area = [&](int i) {
    const Facet& f = world.facets[static_cast<std::size_t>(i)];
    return f.width_m() * f.height_m();
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return area(a) > area(b); });
  parallel_for(static_cast<int>(order.size()), threads, [&](int i) {
    const auto facet = static_cast<std::size_t>(order[static_cast<std::size_t>(i)]);
    surfaces_[facet] = bake(world.facets[facet], coarseness);
  });
}

Renderer::Surface Renderer::bake(const Facet& facet, double coarseness) const {
  const LightMap light(world_, caster_, facet, facet.light_cell_m * coarseness);
  const double texel_m = facet.texel_m * coarseness;
  const auto count = [&](double length_m) {
    return std::clamp(static_cast<int>(std::ceil(length_m / texel_m)), 1, kMaxTexels);
  };
  const int columns = count(facet.width_m()), rows = count(facet.height_m());
  const auto width_m = static_cast<float>(facet.width_m()), height_m = static_cast<float>(facet.height_m());
  Surface out;
  out.normal = facet.normal.cast<float>();
  out.texels_per_m = static_cast<float>(columns) / width_m;
  out.radiance = Texture(columns, rows, [&](int column, int row) {
    const float u = (static_cast<float>(column) + 0.5F) / static_cast<float>(columns);
    const float v = (static_cast<float>(row) + 0.5F) / static_cast<float>(rows);
    const SurfacePoint p{u * width_m + static_cast<float>(facet.offset_u_m),
                         v * height_m + static_cast<float>(facet.offset_v_m), width_m, height_m};
    return albedo(facet.material, p) * (light.at(u, v) + facet.emission);
  });
  return out;
}

float Renderer::shade(const FacetHit& hit, const Eigen::Vector3f& direction, float pixel_rad) const {
  if (hit.facet == kNoFacet) return 0;
  const Surface& surface = surfaces_[hit.facet];
  const float length = direction.norm();
  const float cosine = std::max(0.02F, std::abs(surface.normal.dot(direction)) / length);
  const float across_m = hit.distance * length * pixel_rad;
  const float read_m = across_m * std::max(kShareAcross, kShareAlong / cosine);
  return surface.radiance.sample(hit.u, hit.v, read_m * surface.texels_per_m);
}

Renderer::Renderer(const World& world, const Caster& caster, const std::vector<Mesh>& parts, int threads,
                   double coarseness)
    : Renderer(world, caster, threads, coarseness) {
  bake_parts(parts, threads, coarseness);
}

void Renderer::bake_parts(const std::vector<Mesh>& parts, int threads, double coarseness) {
  parts_.resize(parts.size());
  parallel_for(static_cast<int>(parts.size()), threads, [&](int i) {
    const Mesh& mesh = parts[static_cast<std::size_t>(i)];
    PartSurface& part = parts_[static_cast<std::size_t>(i)];
    part.mesh = &mesh;
    for (const Skin& skin : mesh.skins) {
      const double texel_m = skin.texel_m * coarseness;
      const auto width_m = static_cast<float>(skin.width_m), height_m = static_cast<float>(skin.height_m);
      const int columns = std::clamp(static_cast<int>(std::ceil(skin.width_m / texel_m)), 1, kMaxTexels);
      const int rows = std::clamp(static_cast<int>(std::ceil(skin.height_m / texel_m)), 1, kMaxTexels);
      part.albedo.emplace_back(columns, rows, [&](int column, int row) {
        const float u = (static_cast<float>(column) + 0.5F) / static_cast<float>(columns);
        const float v = (static_cast<float>(row) + 0.5F) / static_cast<float>(rows);
        return albedo(skin.material, {u * width_m, v * height_m, width_m, height_m});
      });
      part.texels_per_m.push_back(static_cast<float>(columns) / width_m);
    }
    for (const MeshVertex& vertex : mesh.vertices) part.middle += vertex.point.cast<double>();
    part.middle /= static_cast<double>(mesh.vertices.size());
  });
}

// Something close above the floor takes light from it.
struct FloorShade {
  Eigen::Vector2f middle;
  float strength = 0, spread_m = 0;
};

struct Renderer::LitParts {
  struct Part {
    Eigen::Matrix3f part_from_world;
    Eigen::Vector3f origin;    // world
    std::vector<float> light;  // of the vertices
  };
  const PosedParts* posed = nullptr;
  std::vector<Part> parts;
  std::vector<FloorShade> shades;

  float on_floor(const Eigen::Vector3f& point) const {
    float share = 1;
    for (const FloorShade& shade : shades) {
      const float off = (point.head<2>() - shade.middle).squaredNorm() / (shade.spread_m * shade.spread_m);
      if (off < 6.0F) share *= 1.0F - shade.strength * std::exp(-off);
    }
    return share;
  }
};

Renderer::LitParts Renderer::light(const PosedParts& posed) const {
  constexpr double kShadeUpToM = 0.45, kCrowded = 0.9;
  LitParts out;
  out.posed = &posed;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Rigid3& world_from_part = posed.world_from_part(i);
    const Eigen::Matrix3d rotation = world_from_part.rotation.toRotationMatrix();
    LitParts::Part part{rotation.transpose().cast<float>(), world_from_part.translation.cast<float>(), {}};
    part.light.reserve(parts_[i].mesh->vertices.size());
    for (const MeshVertex& v : parts_[i].mesh->vertices) {
      const Eigen::Vector3d normal = rotation * v.normal.cast<double>();
      part.light.push_back(
          static_cast<float>(kCrowded * unshaded_light(world_, world_from_part * v.point.cast<double>(), normal)));
    }
    out.parts.push_back(std::move(part));
    const Eigen::Vector3d middle = world_from_part * parts_[i].middle;
    if (middle.z() < kShadeUpToM) {
      const double height = middle.z() / kShadeUpToM;
      out.shades.push_back({middle.head<2>().cast<float>(), static_cast<float>(0.45 * (1 - height)),
                            static_cast<float>(0.14 + 0.25 * height)});
    }
  }
  return out;
}

float Renderer::shade_part(const LitParts& lit, const FacetHit& hit, const Eigen::Vector3f& direction,
                           float pixel_rad) const {
  const PartSurface& surface = parts_[hit.part];
  const LitParts::Part& part = lit.parts[hit.part];
  const MeshTriangle& triangle = surface.mesh->triangles[hit.facet];
  const auto& [ia, ib, ic] = triangle.corners;
  const MeshVertex &a = surface.mesh->vertices[ia], &b = surface.mesh->vertices[ib], &c = surface.mesh->vertices[ic];
  const float share_a = 1.0F - hit.u - hit.v;
  const Eigen::Vector2f uv = share_a * a.uv + hit.u * b.uv + hit.v * c.uv;
  const float light = share_a * part.light[ia] + hit.u * part.light[ib] + hit.v * part.light[ic];
  const float length = direction.norm();
  const Eigen::Vector3f normal = (b.point - a.point).cross(c.point - a.point).normalized();
  const float cosine = std::max(0.02F, std::abs(normal.dot(part.part_from_world * direction)) / length);
  const float read_m = hit.distance * length * pixel_rad * std::max(kShareAcross, kShareAlong / cosine);
  return light * surface.albedo[triangle.skin].sample(uv.x(), uv.y(), read_m * surface.texels_per_m[triangle.skin]);
}

cv::Mat1f Renderer::radiance(const RayTable& rays, const Rigid3& cam_from_world, const PosedParts* posed,
                             cv::Mat1b* moving) const {
  constexpr float kFloorM = 0.05F;
  const LitParts lit = posed != nullptr ? light(*posed) : LitParts();
  const Eigen::Matrix3f world_from_cam = cam_from_world.rotation.conjugate().toRotationMatrix().cast<float>();
  const Eigen::Vector3f origin = cam_from_world.center().cast<float>();
  const auto pixel_rad = static_cast<float>(1.0 / rays.focal_px());
  cv::Mat1f out(rays.height(), rays.width());
  if (moving != nullptr) *moving = cv::Mat1b::zeros(rays.height(), rays.width());
  const auto moves = [&](const FacetHit& hit, const Eigen::Vector3f& direction) {
    const LitParts::Part& part = lit.parts[hit.part];
    const Eigen::Vector3f in_part = part.part_from_world * (origin + hit.distance * direction - part.origin);
    return posed->velocity(hit.part, in_part.cast<double>()).norm() > kMovingSpeed_m_s;
  };
  for (int y = 0; y < rays.height(); ++y) {
    for (int x = 0; x < rays.width(); ++x) {
      Caster::Directions directions;
      for (int k = 0; k < RayTable::kRays; ++k) {
        directions.col(k) = world_from_cam * rays.ray(x, y, k).homogeneous();
      }
      const auto hits =
          posed != nullptr ? posed->caster().cast_packet(origin, directions) : caster_.cast_packet(origin, directions);
      float sum = 0;
      int rays_moving = 0;
      for (int k = 0; k < RayTable::kRays; ++k) {
        const FacetHit& hit = hits[static_cast<std::size_t>(k)];
        const Eigen::Vector3f direction = directions.col(k);
        if (hit.part != kNoPart) {
          sum += shade_part(lit, hit, direction, pixel_rad);
          if (moving != nullptr && moves(hit, direction)) ++rays_moving;
          continue;
        }
        float value = shade(hit, direction, pixel_rad);
        if (posed != nullptr && hit.facet != kNoFacet && origin.z() + hit.distance * direction.z() < kFloorM) {
          value *= lit.on_floor(origin + hit.distance * direction);
        }
        sum += value;
      }
      out(y, x) = sum / RayTable::kRays;
      if (2 * rays_moving > RayTable::kRays) (*moving)(y, x) = 255;
    }
  }
  return out;
}

cv::Mat1w Renderer::depth_mm(const RayTable& rays, const Rigid3& cam_from_world, const PosedParts* posed) const {
  const Eigen::Matrix3d world_from_cam = cam_from_world.rotation.conjugate().toRotationMatrix();
  const Eigen::Vector3d origin = cam_from_world.center();
  cv::Mat1w out(rays.height(), rays.width());
  for (int y = 0; y < rays.height(); ++y) {
    for (int x = 0; x < rays.width(); ++x) {
      // The direction has z = 1 in the camera, so that the distance along it is the depth.
      const Eigen::Vector3d direction = world_from_cam * rays.central(x, y).cast<double>().homogeneous();
      const auto hit = posed != nullptr ? posed->caster().cast(origin, direction) : caster_.cast(origin, direction);
      const float mm = hit ? hit->distance * 1000.0F : 0.0F;
      out(y, x) = mm < 65535.0F ? static_cast<std::uint16_t>(std::lround(mm)) : std::uint16_t{0};
    }
  }
  return out;
}

}  // namespace coslam::sim
