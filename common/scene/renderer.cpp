// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/scene/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/scene/lighting.h"
#include "common/scene/parallel.h"

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
  const LightMap light(world_, caster_, facet, LightMap::kCellM * coarseness);
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

cv::Mat1f Renderer::radiance(const RayTable& rays, const Rigid3& cam_from_world) const {
  const Eigen::Matrix3f world_from_cam = cam_from_world.rotation.conjugate().toRotationMatrix().cast<float>();
  const Eigen::Vector3f origin = cam_from_world.center().cast<float>();
  const auto pixel_rad = static_cast<float>(1.0 / rays.focal_px());
  cv::Mat1f out(rays.height(), rays.width());
  for (int y = 0; y < rays.height(); ++y) {
    for (int x = 0; x < rays.width(); ++x) {
      Caster::Directions directions;
      for (int k = 0; k < RayTable::kRays; ++k) {
        directions.col(k) = world_from_cam * rays.ray(x, y, k).homogeneous();
      }
      const auto hits = caster_.cast_packet(origin, directions);
      float sum = 0;
      for (int k = 0; k < RayTable::kRays; ++k) {
        sum += shade(hits[static_cast<std::size_t>(k)], directions.col(k), pixel_rad);
      }
      out(y, x) = sum / RayTable::kRays;
    }
  }
  return out;
}

cv::Mat1w Renderer::depth_mm(const RayTable& rays, const Rigid3& cam_from_world) const {
  const Eigen::Matrix3d world_from_cam = cam_from_world.rotation.conjugate().toRotationMatrix();
  const Eigen::Vector3d origin = cam_from_world.center();
  cv::Mat1w out(rays.height(), rays.width());
  for (int y = 0; y < rays.height(); ++y) {
    for (int x = 0; x < rays.width(); ++x) {
      // The direction has z = 1 in the camera, so that the distance along it is the depth.
      const auto hit = caster_.cast(origin, world_from_cam * rays.central(x, y).cast<double>().homogeneous());
      const float mm = hit ? hit->distance * 1000.0F : 0.0F;
      out(y, x) = mm < 65535.0F ? static_cast<std::uint16_t>(std::lround(mm)) : std::uint16_t{0};
    }
  }
  return out;
}

}  // namespace coslam::sim
