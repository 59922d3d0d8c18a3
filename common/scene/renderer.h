// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"
#include "common/scene/caster.h"
#include "common/scene/texture.h"
#include "common/scene/world.h"

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

// Draws a world without moving parts. Light and textures are computed once, at construction; after that thread-safe.
// The world and the caster must outlive it.
class Renderer {
 public:
  // coarseness > 1: textures and shadows coarser by that factor, for tests.
  Renderer(const World& world, const Caster& caster, int threads, double coarseness = 1.0);

  cv::Mat1f radiance(const RayTable& rays, const Rigid3& cam_from_world) const;
  // Depth along z of the pixel centres in millimetres; 0 where nothing is met or it is beyond 65 m.
  cv::Mat1w depth_mm(const RayTable& rays, const Rigid3& cam_from_world) const;

 private:
  // What shading needs of a facet, close together.
  struct Surface {
    Texture radiance;
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    float texels_per_m = 0;
  };
  Surface bake(const Facet& facet, double coarseness) const;
  float shade(const FacetHit& hit, const Eigen::Vector3f& direction, float pixel_rad) const;

  const World& world_;
  const Caster& caster_;
  std::vector<Surface> surfaces_;
};

}  // namespace coslam::sim
