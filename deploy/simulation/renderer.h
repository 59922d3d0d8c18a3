// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"
#include "deploy/simulation/caster.h"
#include "deploy/simulation/posed_parts.h"
#include "deploy/simulation/texture.h"
#include "deploy/simulation/world.h"

namespace coslam::sim {

// The rays of a camera's pixels in its own frame, as normalized coordinates (z = 1): four a pixel on a turned grid for
// the image, one through the centre for depth. NaN where the lens model has no ray.
class RayTable {
 public:
  static constexpr int kRays = Caster::kPacket;

  RayTable(const CameraModel& camera, int threads);
  int width() const { return width_; }
  int height() const { return height_; }
  double focal_px() const { return focal_px_; }
  const Eigen::Vector2f& ray(int x, int y, int k) const {
    return rays_[index(x, y) * kRays + static_cast<std::size_t>(k)];
  }
  const Eigen::Vector2f& central(int x, int y) const { return central_[index(x, y)]; }

 private:
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y * width_ + x); }

  int width_, height_;
  double focal_px_;
  std::vector<Eigen::Vector2f> rays_, central_;
};

// Draws a world and what moves in it. The light on the world and all textures are computed once, at construction; after
// that thread-safe. Moving things are lit by the lights and darken the floor around their feet, but throw no shadow on
// each other. The world, the caster and the parts must outlive it.
class Renderer {
 public:
  // coarseness > 1: textures and shadows coarser by that factor, for tests.
  Renderer(const World& world, const Caster& caster, int threads, double coarseness = 1.0);
  Renderer(const World& world, const Caster& caster, const std::vector<Mesh>& parts, int threads, double coarseness);

  // posed: where the parts are; null draws the world alone. moving: 255 where most of a pixel shows something that
  // moves (Scene::moving), else 0.
  cv::Mat1f radiance(const RayTable& rays, const Rigid3& cam_from_world, const PosedParts* posed = nullptr,
                     cv::Mat1b* moving = nullptr) const;
  // Depth along z of the pixel centres in millimetres; 0 where nothing is met or it is beyond 65 m.
  cv::Mat1w depth_mm(const RayTable& rays, const Rigid3& cam_from_world, const PosedParts* posed = nullptr) const;

 private:
  // Data of a facet for shading, close together.
  struct Surface {
    Texture radiance;
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    float texels_per_m = 0;
  };
  Surface bake(const Facet& facet, double coarseness) const;
  float shade(const FacetHit& hit, const Eigen::Vector3f& direction, float pixel_rad) const;
  // Data of the skins of a part for shading.
  struct PartSurface {
    const Mesh* mesh = nullptr;
    std::vector<Texture> albedo;
    std::vector<float> texels_per_m;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  };
  // The parts of one instant under the lights.
  struct LitParts;
  void bake_parts(const std::vector<Mesh>& parts, int threads, double coarseness);
  LitParts light(const PosedParts& posed) const;
  float shade_part(const LitParts& lit, const FacetHit& hit, const Eigen::Vector3f& direction, float pixel_rad) const;

  const World& world_;
  const Caster& caster_;
  std::vector<Surface> surfaces_;
  std::vector<PartSurface> parts_;
};

}  // namespace coslam::sim
