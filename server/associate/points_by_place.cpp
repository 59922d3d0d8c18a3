// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/associate/points_by_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace coslam {
namespace {

constexpr std::size_t kMostInBox = 32;
// What is left out by rough arithmetic is left out by the exact one as well.
constexpr double kRounding = 1e-9, kSlack_px = 0.01;

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

PointsByPlace::PointsByPlace(const std::vector<const MapPoint*>& points) {
  for (const MapPoint* p : points) places_.push_back({p, p->position, p->covariance.trace()});
  std::ranges::stable_sort(places_, {}, [](const Place& p) { return p.point->map; });
  for (std::size_t first = 0; first < places_.size();) {
    std::size_t last = first;
    while (last < places_.size() && places_[last].point->map == places_[first].point->map) ++last;
    split(first, last);
    first = last;
  }
}

void PointsByPlace::split(std::size_t first, std::size_t last) {
  Box box{places_[first].point->map, places_[first].position, places_[first].position, first, last};
  for (std::size_t i = first; i < last; ++i) {
    box.low = box.low.cwiseMin(places_[i].position);
    box.high = box.high.cwiseMax(places_[i].position);
  }
  if (last - first <= kMostInBox) {
    boxes_.push_back(box);
    return;
  }
  Eigen::Index axis = 0;
  (box.high - box.low).maxCoeff(&axis);
  const std::size_t middle = first + (last - first) / 2;
  const auto at = [this](std::size_t i) { return places_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(first), at(middle), at(last),
                   [&](const Place& a, const Place& b) { return a.position[axis] < b.position[axis]; });
  split(first, middle);
  split(middle, last);
}

std::vector<const MapPoint*> PointsByPlace::near_tracks(const MapCamera& camera, const TrackGrid& grid,
                                                        const SearchRadius& radius) const {
  const CameraModel& c = camera.model;
  const Frustum frustum = frustum_of(camera, search_margin_px(c).array() + radius.most_px);
  const Rigid3& pose = camera.frames.back().cam_from_world;
  const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
  const double focal2 = std::pow(std::max(c.fx, c.fy), 2);
  std::vector<const MapPoint*> out;
  const auto look_at = [&](const Place& p) {
    const Eigen::Vector3d in_cam = rotation * p.position + pose.translation;
    if (in_cam.z() <= 0) return;
    // By the norm of the projection's derivative, f / z sqrt(2 + (x^2 + y^2) / z^2).
    const double nearness = 1 / in_cam.z();
    const Eigen::Vector2d n = nearness * in_cam.head<2>();
    const double variance_px2 = focal2 * nearness * nearness * (2 + n.squaredNorm()) * p.variance;
    if (grid.any_near(c.pixel_from_normalized(n), radius.of(variance_px2) + kSlack_px)) out.push_back(p.point);
  };
  for (const Box& b : boxes_) {
    if (b.map != camera.map || !may_reach(b.low, b.high, frustum)) continue;
    for (std::size_t i = b.first; i < b.last; ++i) look_at(places_[i]);
  }
  std::ranges::sort(out, {}, &MapPoint::id);
  return out;
}

void PointsByPlace::moved(const MapPoint& point) {
  for (Box& b : boxes_) {
    if (b.map != point.map) continue;
    for (std::size_t i = b.first; i < b.last; ++i) {
      if (places_[i].point != &point) continue;
      places_[i] = {&point, point.position, point.covariance.trace()};
      b.low = b.low.cwiseMin(point.position);
      b.high = b.high.cwiseMax(point.position);
      return;
    }
  }
}

}  // namespace coslam
