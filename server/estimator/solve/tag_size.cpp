// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/tag_size.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include "common/geometry/triangulation.h"

namespace coslam {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kLeastParallax_rad = 1e-3;  // what is below comes from the noise of the poses
constexpr double kSquareChiSquare = 20.5;    // 99.9 % of squares, 5 degrees of freedom

struct Corners {
  std::array<Vector3d, 4> position;
  std::array<Matrix3d, 4> covariance;  // for a standard deviation of one pixel
};

std::optional<Corners> triangulate_corners(std::span<const TagView> views) {
  Corners out;
  for (std::size_t k = 0; k < 4; ++k) {
    std::vector<View> of_corner;
    for (const TagView& v : views) of_corner.push_back({v.model, v.cam_from_world, v.undistorted_px[k]});
    const TriangulationResult t = triangulate(of_corner, 1.0, kLeastParallax_rad);
    if (t.status != TriangulationStatus::kOk) return std::nullopt;
    out.position[k] = t.position;
    out.covariance[k] = t.covariance;
  }
  return out;
}

// RMS distance over the four corners.
double error_of(const TagView& v, const Corners& corners) {
  double squares = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    Eigen::Vector2d px;
    if (!project_world(*v.model, v.cam_from_world, corners.position[k], &px)) return 1e9;
    squares += (px - v.undistorted_px[k]).squaredNorm();
  }
  return std::sqrt(squares / 4);
}

struct Agreed {
  std::vector<TagView> views;
  Corners corners;
  double squares = 0;  // of all coordinates
};

// Leaves the worst view out until the others agree. A tag at two places leaves no such rest.
TagStatus agree(std::span<const TagView> all, double most_wrong, Agreed* out) {
  out->views.assign(all.begin(), all.end());
  const auto least = static_cast<std::size_t>(std::ceil((1 - most_wrong) * static_cast<double>(all.size())));
  while (true) {
    if (out->views.size() < 2) return TagStatus::kUndetermined;
    const auto corners = triangulate_corners(out->views);
    if (!corners) return TagStatus::kUndetermined;
    out->corners = *corners;
    out->squares = 0;
    double worst = 0;
    auto worst_at = out->views.begin();
    for (auto v = out->views.begin(); v != out->views.end(); ++v) {
      const double error = error_of(*v, *corners);
      out->squares += 4 * error * error;
      if (error / v->gate_px <= worst) continue;
      worst = error / v->gate_px;
      worst_at = v;
    }
    if (worst <= 1) return TagStatus::kOk;
    if (most_wrong * static_cast<double>(all.size()) < 1) return TagStatus::kUndetermined;  // which of so few is wrong?
    if (out->views.size() <= least) return TagStatus::kNotOnePlace;
    out->views.erase(worst_at);
  }
}

// Corner k of a square of side 1 in its own frame: x right, y down.
Vector3d unit_corner(std::size_t k) {
  constexpr std::array<std::array<double, 2>, 4> kCorners{{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}};
  return {kCorners[k][0], kCorners[k][1], 0};
}

struct Square {
  Matrix3d rotation;
  Vector3d middle;
  double side = 0;
  double sigma = 0, chi_square = 0;
};

Square rough_square(const std::array<Vector3d, 4>& p) {
  Square s;
  s.middle = (p[0] + p[1] + p[2] + p[3]) / 4;
  const Vector3d x = p[1] - p[0] + p[2] - p[3], y = p[3] - p[0] + p[2] - p[1];
  s.side = (x.norm() + y.norm()) / 4;
  s.rotation.col(0) = x.normalized();
  s.rotation.col(2) = x.cross(y).normalized();
  s.rotation.col(1) = s.rotation.col(2).cross(s.rotation.col(0));
  return s;
}

std::optional<Square> fit_square(const std::array<Vector3d, 4>& corners, const std::array<Matrix3d, 4>& covariances) {
  constexpr int kRounds = 10;
  using Matrix7d = Eigen::Matrix<double, 7, 7>;
  using Vector7d = Eigen::Matrix<double, 7, 1>;
  Square s = rough_square(corners);
  for (int round = 0; round < kRounds; ++round) {
    Matrix7d jtj = Matrix7d::Zero();
    Vector7d jtr = Vector7d::Zero();
    s.chi_square = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vector3d arm = s.rotation * unit_corner(k);
      const Vector3d r = corners[k] - s.middle - s.side * arm;
      Eigen::Matrix<double, 3, 7> j;  // turn, middle, side
      j.leftCols<3>() << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
      j.leftCols<3>() *= s.side;
      j.middleCols<3>(3).setIdentity();
      j.col(6) = arm;
      const Matrix3d information = covariances[k].inverse();
      jtj += j.transpose() * information * j;
      jtr += j.transpose() * information * r;
      s.chi_square += r.dot(information * r);
    }
    const Eigen::LDLT<Matrix7d> ldlt(jtj);
    const Vector7d step = ldlt.solve(jtr);
    if (ldlt.info() != Eigen::Success || !step.allFinite()) return std::nullopt;
    s.sigma = std::sqrt(ldlt.solve(Vector7d::Unit(6))[6]);
    const double angle = step.head<3>().norm();
    if (angle > 0) s.rotation = Eigen::AngleAxisd(angle, step.head<3>() / angle) * s.rotation;
    s.middle += step.segment<3>(3);
    s.side += step[6];
  }
  return s.side > 0 && std::isfinite(s.sigma) ? std::optional(s) : std::nullopt;
}

}  // namespace

TagSize measure_tag(std::span<const TagView> views, const TagSizeConfig& config) {
  TagSize out;
  Agreed agreed;
  out.status = agree(views, config.most_wrong, &agreed);
  out.views = static_cast<int>(agreed.views.size());
  if (out.status != TagStatus::kOk) return out;

  const double n = static_cast<double>(agreed.views.size());
  out.error_px = std::sqrt(agreed.squares / (8 * n - 12));
  std::set<CameraId> cameras;
  for (const TagView& v : agreed.views) cameras.insert(v.camera);
  const double repeats = std::max(1.0, n / (2.0 * static_cast<double>(cameras.size())));
  const double sigma_px = std::max(config.sigma_px, out.error_px) * std::sqrt(repeats);

  const double flat = config.flatness * rough_square(agreed.corners.position).side;
  for (Matrix3d& c : agreed.corners.covariance) c = c * sigma_px * sigma_px + flat * flat * Matrix3d::Identity();
  const auto square = fit_square(agreed.corners.position, agreed.corners.covariance);
  out.status = TagStatus::kUndetermined;
  if (!square) return out;
  out.side = square->side;
  out.sigma = square->sigma;
  out.chi_square = square->chi_square;
  out.status = square->chi_square < kSquareChiSquare ? TagStatus::kOk : TagStatus::kNotSquare;
  return out;
}

}  // namespace coslam
