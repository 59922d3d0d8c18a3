// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>

#include "deploy/coslam/export/colmap_model.h"

namespace coslam::exporting {

inline const CameraModel kBarrel{752, 480, 458, 457, 367, 248, DistortionModel::kRadTan, {-0.28, 0.07, 0, 0}};
inline const CameraModel kPinhole{640, 480, 500, 510, 312, 250, DistortionModel::kNone, {}};

// A box of points, and a barrel and a pinhole camera that go past it by turns while they look at its middle. All
// observations are right up to the noise, and linked.
inline ColmapModel simulated_model(std::size_t images, int points, double noise_px, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> side(-1.5, 1.5);
  std::normal_distribution<double> noise(0, 1);
  ColmapModel model;
  model.cameras.push_back({{.name = "a"}, kBarrel, {}});
  model.cameras.push_back({{.name = "b"}, kPinhole, {}});
  for (int i = 1; i <= points; ++i) {
    model.points[PointId(static_cast<std::uint32_t>(i))].position = {side(random), side(random), 5 + side(random)};
  }
  for (std::size_t i = 0; i < images; ++i) {
    const double part = images < 2 ? 0 : static_cast<double>(i) / static_cast<double>(images - 1) - 0.5;
    const Rigid3 world_from_cam(so3_exp({0.05 * std::sin(9 * part), -0.35 * part, 0.1 * part}),
                                {2 * part, 0.3 * std::cos(7 * part), 0});
    ColmapModel::Image image{.camera = i % 2,
                             .frame = FrameId(static_cast<std::uint32_t>(10 * (i / 2))),
                             .t_ns = static_cast<TimeNs>(i / 2) * 500'000'000,
                             .cam_from_world = world_from_cam.inverse()};
    const CameraModel& lens = model.cameras[image.camera].model;
    for (const auto& [id, point] : model.points) {
      const Eigen::Vector3d in_cam = image.cam_from_world * point.position;
      const Eigen::Vector2d px = lens.raw_from_undistorted(lens.project(in_cam));
      if (lens.contains_raw(px)) {
        image.observations.push_back({px + noise_px * Eigen::Vector2d(noise(random), noise(random)), id});
      }
    }
    model.images.push_back(std::move(image));
  }
  link_points(&model);
  return model;
}

}  // namespace coslam::exporting
