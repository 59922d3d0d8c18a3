// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/patch_match.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

namespace coslam {

namespace {

// Correlation over the square that stays `margin` clear of the border in a, and lies (dx, dy) from there in b.
double correlation(const PatchGrey& a, const PatchGrey& b, int margin, int dx, int dy) {
  std::int64_t sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (int row = margin; row < kPatchSide - margin; ++row) {
    const auto* pa = a.data() + row * kPatchSide;
    const auto* pb = b.data() + (row + dy) * kPatchSide + dx;
    for (int col = margin; col < kPatchSide - margin; ++col) {
      const std::int64_t x = pa[col], y = pb[col];
      sa += x;
      sb += y;
      saa += x * x;
      sbb += y * y;
      sab += x * y;
    }
  }
  const std::int64_t side = kPatchSide - 2 * margin, n = side * side;
  const double va = static_cast<double>(n * saa - sa * sa), vb = static_cast<double>(n * sbb - sb * sb);
  const double flat = 4.0 * static_cast<double>(n * n);  // a standard deviation of two grey values is noise
  if (va < flat || vb < flat) return 0;
  return static_cast<double>(n * sab - sa * sb) / std::sqrt(va * vb);
}

}  // namespace

double zncc(const PatchGrey& a, const PatchGrey& b) { return correlation(a, b, 0, 0, 0); }

namespace {

constexpr double kImageByPatch = 1 / 0.3;

// Peak of the parabola through three values at -1, 0 and 1; empty where they have none.
std::optional<double> peak_of(double before, double middle, double after) {
  const double bend = 2 * middle - after - before;
  return bend > 0 ? std::optional((after - before) / (2 * bend)) : std::nullopt;
}

}  // namespace

bool same_centre(const PatchGrey& a, const PatchGrey& b) {
  constexpr double kMost_px = 1.33;
  const double middle = correlation(a, b, 1, 0, 0);
  const auto dx = peak_of(correlation(a, b, 1, -1, 0), middle, correlation(a, b, 1, 1, 0));
  const auto dy = peak_of(correlation(a, b, 1, 0, -1), middle, correlation(a, b, 1, 0, 1));
  return dx && dy && kImageByPatch * Eigen::Vector2d(*dx, *dy).norm() <= kMost_px;
}

std::optional<PatchPeak> peak_in(const PatchGrey& a, const PatchGrey& b) {
  constexpr int kMargin = 2;  // one for the search, one for the parabola
  constexpr double kWorthLooking = 0.2;
  if (correlation(a, b, kMargin, 0, 0) < kWorthLooking) return std::nullopt;
  PatchPeak best;
  int x = 0, y = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const double value = correlation(a, b, kMargin, dx, dy);
      if (value <= best.zncc) continue;
      best.zncc = value;
      x = dx;
      y = dy;
    }
  }
  const auto across = peak_of(correlation(a, b, kMargin, x - 1, y), best.zncc, correlation(a, b, kMargin, x + 1, y));
  const auto down = peak_of(correlation(a, b, kMargin, x, y - 1), best.zncc, correlation(a, b, kMargin, x, y + 1));
  constexpr double kBetweenPixels = 0.6;  // farther off, the peak lies outside what was searched
  if (!across || !down || std::abs(*across) > kBetweenPixels || std::abs(*down) > kBetweenPixels) return std::nullopt;
  best.shift_px = kImageByPatch * Eigen::Vector2d(x + *across, y + *down);
  return best.shift_px.norm() <= kMostShift_px ? std::optional(best) : std::nullopt;
}

PatchGrey warped(const PatchGrey& other, const Eigen::Matrix2d& image_from_other) {
  constexpr int kHalf = kPatchSide / 2;
  const Eigen::Matrix2f other_from_image = image_from_other.inverse().cast<float>();
  PatchGrey out;
  for (int row = 0; row < kPatchSide; ++row) {
    for (int col = 0; col < kPatchSide; ++col) {
      const Eigen::Vector2f at =
          other_from_image * Eigen::Vector2f(static_cast<float>(col - kHalf), static_cast<float>(row - kHalf));
      const float x = std::clamp(at.x() + kHalf, 0.0F, kPatchSide - 1.0F);
      const float y = std::clamp(at.y() + kHalf, 0.0F, kPatchSide - 1.0F);
      const int x0 = std::min(static_cast<int>(x), kPatchSide - 2), y0 = std::min(static_cast<int>(y), kPatchSide - 2);
      const float u = x - static_cast<float>(x0), v = y - static_cast<float>(y0);
      const auto* p = other.data() + y0 * kPatchSide + x0;
      const float upper = static_cast<float>(p[0]) * (1 - u) + static_cast<float>(p[1]) * u;
      const float lower = static_cast<float>(p[kPatchSide]) * (1 - u) + static_cast<float>(p[kPatchSide + 1]) * u;
      out[static_cast<std::size_t>(row * kPatchSide + col)] =
          static_cast<std::uint8_t>(std::lround(upper * (1 - v) + lower * v));
    }
  }
  return out;
}

namespace {

struct Look {
  const MapCamera* camera;
  Rigid3 pose;
  Eigen::Vector3d ray;  // unit, camera to point
};

Look look_at(const MapCamera& camera, const Rigid3& pose, const Eigen::Vector3d& position) {
  return {&camera, pose, (position - pose.center()).normalized()};
}

// Raw pixels by steps of a tangent plane of the point.
Eigen::Matrix2d raw_by_plane(const Look& look, const Eigen::Vector3d& position,
                             const Eigen::Matrix<double, 3, 2>& tangents) {
  const CameraModel& model = look.camera->model;
  Eigen::Vector2d px;
  Eigen::Matrix<double, 2, 3> j;
  if (!project_world(model, look.pose, position, &px, &j)) return Eigen::Matrix2d::Zero();
  return std::exp(look.camera->lens.log_focal()) * model.raw_by_undistorted(px) * j * tangents;
}

Eigen::Matrix2d image_from_other(const Look& image, const Look& other, const Eigen::Vector3d& position) {
  const Eigen::Vector3d normal = (image.ray + other.ray).normalized();
  Eigen::Matrix<double, 3, 2> tangents;
  tangents.col(0) = normal.unitOrthogonal();
  tangents.col(1) = normal.cross(tangents.col(0));
  return raw_by_plane(image, position, tangents) * raw_by_plane(other, position, tangents).inverse();
}

}  // namespace

std::optional<AlikePatches> made_alike(const PatchSight& first, const PatchSight& second,
                                       const Eigen::Vector3d& position) {
  const Eigen::Matrix2d first_from_second =
      image_from_other(look_at(*first.camera, first.cam_from_world, position),
                       look_at(*second.camera, second.cam_from_world, position), position);
  const double growth = first_from_second.determinant();
  constexpr double kMostGrowth = 6.25;  // of the area
  if (!(growth > 1 / kMostGrowth && growth < kMostGrowth)) return std::nullopt;
  // The one that shows more detail is made like the other: it holds all that the other shows.
  const Eigen::Matrix2d second_from_first = first_from_second.inverse();
  if (growth > 1) {
    return AlikePatches{warped(*first.patch, second_from_first), *second.patch, true, Eigen::Matrix2d::Identity()};
  }
  return AlikePatches{*first.patch, warped(*second.patch, first_from_second), false, second_from_first};
}

std::optional<PatchFit> fit_patch(const Map& map, const MapPoint& point, const MapCamera& camera,
                                  const Rigid3& cam_from_world, const PatchGrey& patch) {
  const Eigen::Vector3d view_ray = (point.position - cam_from_world.center()).normalized();
  std::optional<PatchSight> nearest;
  double best_cosine = 0.5;  // from farther round it shows other things, or its other side
  for (const PointPatch& p : point.patches) {
    const MapCamera& c = map.camera(p.camera);
    const FramePose* f = c.frame_at(p.set);
    if (f == nullptr || f->map != point.map) continue;
    const double cosine = view_ray.dot((point.position - f->cam_from_world.center()).normalized());
    if (cosine <= best_cosine) continue;
    best_cosine = cosine;
    nearest = {&c, f->cam_from_world, &p.pixels};
  }
  if (!nearest) return std::nullopt;
  const auto alike = made_alike({&camera, cam_from_world, &patch}, *nearest, point.position);
  if (!alike) return PatchFit{};
  const bool together =
      alike->in_second ? same_centre(alike->second, alike->first) : same_centre(alike->first, alike->second);
  return PatchFit{zncc(alike->first, alike->second), together};
}

}  // namespace coslam
