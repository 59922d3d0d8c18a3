// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/associate/points_by_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace coslam {
namespace {

constexpr Eigen::Index kMostInBox = 64;
// What is left out by rough arithmetic is left out by the exact one as well.
constexpr double kRounding = 1e-6;
constexpr float kSlack_px = 0.01F;

// Half space of the world: inside where normal * x + offset >= 0.
struct HalfSpace {
  Eigen::Vector3d normal;
  double offset = 0;
};
using Frustum = std::array<HalfSpace, 5>;

// In front of the camera and between the planes through its centre and the sides of the image.
Frustum frustum_of(const MapCamera& camera, const Eigen::Vector2d& margin_px) {
  const CameraModel& c = camera.model;
  const Rigid3& pose = camera.frames.back().cam_from_world;
  const Eigen::Vector2d low = c.normalized_from_pixel(-margin_px),
                        high = c.normalized_from_pixel(Eigen::Vector2d(c.width_px, c.height_px) + margin_px);
  const std::array<Eigen::Vector3d, 5> normals = {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, 0, -low.x()),
                                                  Eigen::Vector3d(-1, 0, high.x()), Eigen::Vector3d(0, 1, -low.y()),
                                                  Eigen::Vector3d(0, -1, high.y())};
  Frustum out;
  const Eigen::Matrix3d world_from_cam = pose.rotation.toRotationMatrix().transpose();
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = {world_from_cam * normals[i], normals[i].dot(pose.translation)};
  }
  return out;
}

bool may_reach(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const Frustum& frustum) {
  const Eigen::Vector3d middle = 0.5 * (low + high), half = 0.5 * (high - low);
  return std::ranges::all_of(frustum, [&](const HalfSpace& s) {
    const double furthest = s.normal.dot(middle) + s.normal.cwiseAbs().dot(half) + s.offset;
    return furthest >= -kRounding * (middle.norm() + half.norm() + std::abs(s.offset));
  });
}

}  // namespace

PointsByPlace::PointsByPlace(const std::vector<const MapPoint*>& points) : points_(points) {
  constexpr std::size_t kAhead = 8;  // points lie anywhere in memory
  std::vector<Place> places(points.size());
  bool one_map = true;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i + kAhead < points.size()) {
      __builtin_prefetch(&points[i + kAhead]->map);
      __builtin_prefetch(&points[i + kAhead]->position);
      __builtin_prefetch(&points[i + kAhead]->covariance);
    }
    const MapPoint& p = *points[i];
    places[i] = place_of(p, static_cast<std::uint32_t>(i));
    one_map = one_map && p.map == points.front()->map;
  }
  const auto map_of = [&](const Place& p) { return points_[p.of]->map; };
  if (!one_map) std::ranges::stable_sort(places, {}, map_of);
  for (std::size_t first = 0; first < places.size();) {
    const MapId map = map_of(places[first]);
    std::size_t last = one_map ? places.size() : first;
    while (last < places.size() && map_of(places[last]) == map) ++last;
    split(&places, map, first, last);
    first = last;
  }
  const auto n = static_cast<Eigen::Index>(places.size());
  for (Eigen::ArrayXf* a : {&x_, &y_, &z_, &variance_}) a->resize(n);
  of_.resize(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) hold(i, places[i]);
}

PointsByPlace::Place PointsByPlace::place_of(const MapPoint& point, std::uint32_t of) {
  return {point.position.cast<float>(), static_cast<float>(point.covariance.trace()), of};
}

void PointsByPlace::hold(std::size_t at, const Place& place) {
  const auto i = static_cast<Eigen::Index>(at);
  const Eigen::Vector3f& p = place.position;
  x_[i] = p.x();
  y_[i] = p.y();
  z_[i] = p.z();
  variance_[i] = place.variance;
  of_[at] = place.of;
  furthest_ = std::max(furthest_, p.cwiseAbs().maxCoeff());
}

void PointsByPlace::split(std::vector<Place>* places, MapId map, std::size_t first, std::size_t last) {
  Eigen::Vector3f low = (*places)[first].position, high = low;
  for (std::size_t i = first; i < last; ++i) {
    low = low.cwiseMin((*places)[i].position);
    high = high.cwiseMax((*places)[i].position);
  }
  if (last - first <= kMostInBox) {
    boxes_.push_back({map, low.cast<double>(), high.cast<double>(), first, last});
    return;
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const std::size_t middle = first + (last - first) / 2;
  const auto at = [&](std::size_t i) { return places->begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(first), at(middle), at(last),
                   [&](const Place& a, const Place& b) { return a.position[axis] < b.position[axis]; });
  split(places, map, first, middle);
  split(places, map, middle, last);
}

std::vector<const MapPoint*> PointsByPlace::near_tracks(const MapCamera& camera, const TrackGrid& grid,
                                                        const SearchRadius& radius) const {
  using OfBox = Eigen::Array<float, Eigen::Dynamic, 1, Eigen::ColMajor, kMostInBox, 1>;
  const CameraModel& c = camera.model;
  const Frustum frustum = frustum_of(camera, search_margin_px(c).array() + radius.most_px);
  const Rigid3& pose = camera.frames.back().cam_from_world;
  const Eigen::Matrix3f r = pose.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f t = pose.translation.cast<float>();
  const auto focal = static_cast<float>(std::max(c.fx, c.fy));
  const float error = 8 * std::numeric_limits<float>::epsilon() * (furthest_ + t.cwiseAbs().maxCoeff());
  const auto reach2_px2 = static_cast<float>(radius.reach2_px2()), variances = static_cast<float>(radius.variances());
  std::vector<std::uint32_t> found;
  for (const Box& b : boxes_) {
    if (b.map != camera.map || !may_reach(b.low, b.high, frustum)) continue;
    const auto first = static_cast<Eigen::Index>(b.first), n = static_cast<Eigen::Index>(b.last - b.first);
    const auto x = x_.segment(first, n), y = y_.segment(first, n), z = z_.segment(first, n);
    const OfBox depth = r(2, 0) * x + r(2, 1) * y + r(2, 2) * z + t.z();
    const OfBox nearness = depth.inverse();
    const OfBox u = (r(0, 0) * x + r(0, 1) * y + r(0, 2) * z + t.x()) * nearness;
    const OfBox v = (r(1, 0) * x + r(1, 1) * y + r(1, 2) * z + t.y()) * nearness;
    // By the norm of the projection's derivative, f / z sqrt(2 + (x^2 + y^2) / z^2).
    const OfBox size2 = 2 + u.square() + v.square();
    const OfBox variance_px2 = (focal * nearness).square() * size2 * variance_.segment(first, n);
    const OfBox slack_px = kSlack_px + focal * nearness * size2.sqrt() * error;
    const OfBox reach_px = (reach2_px2 + variances * variance_px2).sqrt() + slack_px;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (depth[i] <= 0) continue;
      const Eigen::Vector2d px = c.pixel_from_normalized({u[i], v[i]});
      if (!grid.may_reach(px, reach_px[i])) continue;
      if (grid.any_near(px, radius.of(variance_px2[i]) + slack_px[i], reach_px[i]))
        found.push_back(of_[b.first + static_cast<std::size_t>(i)]);
    }
  }
  std::ranges::sort(found);
  std::vector<const MapPoint*> out;
  out.reserve(found.size());
  for (const std::uint32_t i : found) out.push_back(points_[i]);
  return out;
}

}  // namespace coslam
