// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "deploy/coslam/calibrate/dialects.h"

namespace coslam {
namespace {

constexpr int kFocals = 4;  // fx, fy, cx, cy come before the coefficients

struct Seen {
  Eigen::Vector2d normalized, raw_px;
};

// Rays all over the image, those that the camera has a place for.
std::vector<Seen> rays_of(const CameraModel& camera) {
  constexpr int kColumns = 32, kRows = 24;
  std::vector<Seen> out;
  for (int y = 0; y <= kRows; ++y) {
    for (int x = 0; x <= kColumns; ++x) {
      const Eigen::Vector2d px(x * (camera.width_px - 1.0) / kColumns, y * (camera.height_px - 1.0) / kRows);
      const auto undistorted = camera.undistorted_from_raw(px);
      if (undistorted) out.push_back({camera.normalized_from_pixel(*undistorted), px});
    }
  }
  return out;
}

CameraModel with_parameters(CameraModel camera, const Eigen::VectorXd& x) {
  camera.fx = x[0];
  camera.fy = x[1];
  camera.cx = x[2];
  camera.cy = x[3];
  for (Eigen::Index i = kFocals; i < x.size(); ++i) camera.coefficients[static_cast<std::size_t>(i - kFocals)] = x[i];
  return camera;
}

Eigen::VectorXd residuals_px(const CameraModel& camera, const std::vector<Seen>& rays) {
  Eigen::VectorXd out(2 * static_cast<Eigen::Index>(rays.size()));
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector2d px = camera.pixel_from_normalized(camera.distort_normalized(rays[i].normalized));
    out.segment<2>(2 * static_cast<Eigen::Index>(i)) = px - rays[i].raw_px;
  }
  return out;
}

}  // namespace

// Levenberg-Marquardt from a pinhole, with numeric derivatives.
NearestCamera nearest_camera(const CameraModel& original, DistortionModel model, int coefficients) {
  constexpr int kIterations = 200;
  constexpr double kStep = 1e-6, kEnough = 1e-12;
  const std::vector<Seen> rays = rays_of(original);
  CameraModel frame = original;
  frame.distortion = coefficients == 0 ? DistortionModel::kNone : model;
  frame.coefficients.fill(0);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(kFocals + coefficients);
  x.head<kFocals>() << original.fx, original.fy, original.cx, original.cy;
  Eigen::VectorXd r = residuals_px(with_parameters(frame, x), rays);
  double lambda = 1e-3;
  for (int i = 0; i < kIterations && r.allFinite(); ++i) {
    Eigen::MatrixXd jacobian(r.size(), x.size());
    for (Eigen::Index j = 0; j < x.size(); ++j) {
      Eigen::VectorXd moved = x;
      const double step = kStep * std::max(1.0, std::abs(x[j]));
      moved[j] += step;
      jacobian.col(j) = (residuals_px(with_parameters(frame, moved), rays) - r) / step;
    }
    Eigen::MatrixXd a = jacobian.transpose() * jacobian;
    a.diagonal() *= 1 + lambda;
    const Eigen::VectorXd candidate = x - a.ldlt().solve(jacobian.transpose() * r);
    const Eigen::VectorXd next = residuals_px(with_parameters(frame, candidate), rays);
    const double gained = r.squaredNorm() - next.squaredNorm();
    if (!(gained > 0)) {
      lambda *= 10;
      if (lambda > 1e8) break;
      continue;
    }
    const bool settled = gained < kEnough * r.squaredNorm();
    lambda = std::max(1e-12, lambda / 10);
    x = candidate;
    r = next;
    if (settled) break;
  }
  NearestCamera out{with_parameters(frame, x), 0};
  for (Eigen::Index i = 0; i + 1 < r.size(); i += 2) out.miss_px = std::max(out.miss_px, r.segment<2>(i).norm());
  if (rays.empty() || !r.allFinite()) out.miss_px = std::numeric_limits<double>::infinity();
  return out;
}

}  // namespace coslam
