// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "common/geometry/lens_traits.h"

// Equations that lens models share. They work on normalized coordinates. n: where the ideal pinhole sees a ray; d:
// where the lens shows it, so that d = n in the middle of the image and fx, fy are the focal lengths there.
namespace coslam::lens {

// Base of all models: what holds unless the model says otherwise.
struct Model {
  // Reason why there is no lens with these coefficients, one sentence, or empty.
  static std::optional<const char*> problem(const LensTerms& /*k*/) { return std::nullopt; }
  // Focal length that files give, over that in the middle of the image.
  static double focal_in_files(const LensTerms& /*k*/) { return 1.0; }
};

// n scaled by a function of r2 = |n|^2.
inline Eigen::Vector2d scale_radially(const Eigen::Vector2d& n, double scale, double scale_by_r2,
                                      Eigen::Matrix2d* jacobian) {
  if (jacobian != nullptr) *jacobian = scale * Eigen::Matrix2d::Identity() + 2 * scale_by_r2 * n * n.transpose();
  return scale * n;
}

// Place where a ray meets the pinhole image, which has no place for rays at 90 degrees and beyond.
inline std::optional<Eigen::Vector2d> normalized_of_ray(const Eigen::Vector3d& ray) {
  constexpr double kLeastCosine = 0.0707;  // 1.5 rad
  if (!(ray.z() > kLeastCosine * ray.norm())) return std::nullopt;
  return ray.hnormalized();
}

}  // namespace coslam::lens
