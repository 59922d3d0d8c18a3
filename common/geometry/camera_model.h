// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/geometry/lens_models.h"

namespace coslam {

// Pinhole camera. Three spaces, each named in identifiers:
//   raw px          the image as captured (distorted)
//   undistorted px  the ideal pinhole image with the same fx, fy, cx, cy (what the estimator and the wire use)
//   normalized      x / z, y / z in the camera frame (x right, y down, z forward)
// Coefficients are in the order of `terms` of the lens model (lens_models.h). fx and fy are the focal lengths in the
// middle of the image, of every lens; files may give others: focal_in_files(), lens_forms.h.
struct CameraModel {
  int width_px = 0;
  int height_px = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  DistortionModel distortion = DistortionModel::kNone;
  LensTerms coefficients{};

  // Whether nothing is known of the lens but a guess of its focal length.
  bool guessed() const { return lens_traits(distortion).guess; }
  double focal_px() const { return 0.5 * (fx + fy); }
  // Lengths that are given for images of 640 pixels width, in pixels of this camera.
  double px_from_640(double px) const { return px * width_px / 640.0; }
  bool contains_raw(const Eigen::Vector2d& px, double margin_px = 0) const;

  Eigen::Vector2d pixel_from_normalized(const Eigen::Vector2d& n) const { return {fx * n.x() + cx, fy * n.y() + cy}; }
  Eigen::Vector2d normalized_from_pixel(const Eigen::Vector2d& p) const {
    return {(p.x() - cx) / fx, (p.y() - cy) / fy};
  }

  // Undistorted pixel of a point in the camera frame; z must be positive.
  Eigen::Vector2d project(const Eigen::Vector3d& in_cam) const {
    return {fx * in_cam.x() / in_cam.z() + cx, fy * in_cam.y() / in_cam.z() + cy};
  }
  // 2x3 Jacobian of project() by the point in the camera frame.
  Eigen::Matrix<double, 2, 3> project_jacobian(const Eigen::Vector3d& in_cam) const;

  // jacobian: by n, where asked for.
  Eigen::Vector2d distort_normalized(const Eigen::Vector2d& n, Eigen::Matrix2d* jacobian = nullptr) const;
  Eigen::Vector2d raw_from_undistorted(const Eigen::Vector2d& undistorted_px) const;
  // 2x2 Jacobian of the above. Noise is even in the raw image only: towards the edge of a wide lens an undistorted
  // pixel is a small part of a raw one, outwards more than across. Multiplied by this a residual in undistorted px is
  // in raw px.
  Eigen::Matrix2d raw_by_undistorted(const Eigen::Vector2d& undistorted_px) const;
  // Inverse of the above; empty where the model cannot be inverted (outside its valid field).
  std::optional<Eigen::Vector2d> undistorted_from_raw(const Eigen::Vector2d& raw_px) const;

  friend bool operator==(const CameraModel&, const CameraModel&) = default;
};

// One sentence that names what is wrong (non-positive focal length, principal point far outside, not finite), or empty.
std::optional<const char*> problem_of(const CameraModel& camera);

}  // namespace coslam
