// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/points_by_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

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

// Bits with two zeros between each and the next.
std::uint32_t spread(std::uint32_t bits) {
  bits = (bits | bits << 16U) & 0x030000FFU;
  bits = (bits | bits << 8U) & 0x0300F00FU;
  bits = (bits | bits << 4U) & 0x030C30C3U;
  return (bits | bits << 2U) & 0x09249249U;
}

// Cells of a box that most of the points are in; the few that lie far out count to the nearest of them.
class Cells {
 public:
  static constexpr unsigned kBits = 7;  // an axis

  // places: any that have a position, at least one.
  explicit Cells(const auto& places) {
    constexpr std::size_t kSample = 256, kLeftOut = 20;  // one in so many, at each end
    constexpr float kNone = 1e-30F;
    const std::size_t step = std::max<std::size_t>(1, places.size() / kSample);
    std::vector<float> values;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      values.clear();
      for (std::size_t i = 0; i < places.size(); i += step) values.push_back(places[i].position[axis]);
      std::ranges::sort(values);
      const std::size_t out = values.size() / kLeftOut;
      low_[axis] = values[out];
      const float size = values[values.size() - 1 - out] - low_[axis];
      per_unit_[axis] = size > kNone ? static_cast<float>(1U << kBits) / size : 0;
    }
  }
  // Its number along a curve that goes through all cells of an eighth before those of the next (Morton).
  std::uint32_t number_of(const Eigen::Vector3f& position) const {
    constexpr float kLast = (1U << kBits) - 1U;
    const Eigen::Array3f cell = ((position - low_).array() * per_unit_).max(0.0F).min(kLast);
    std::uint32_t number = 0;
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      number = number << 1U | spread(static_cast<std::uint32_t>(cell[axis]));
    return number;
  }

 private:
  Eigen::Vector3f low_;
  Eigen::Array3f per_unit_;
};

struct Numbered {
  std::uint32_t number, index;
};

// Ascending by number, by counting.
void sort_by_number(std::vector<Numbered>* numbered) {
  constexpr unsigned kDigit = 11;  // bits
  static_assert(2 * kDigit >= 3 * Cells::kBits);
  std::vector<Numbered> other(numbered->size());
  for (unsigned shift = 0; shift < 2 * kDigit; shift += kDigit) {
    const auto digit = [&](const Numbered& n) { return n.number >> shift & ((1U << kDigit) - 1U); };
    std::array<std::uint32_t, (1U << kDigit) + 1> begin{};
    for (const Numbered& n : *numbered) ++begin[digit(n) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    for (const Numbered& n : *numbered) other[begin[digit(n)]++] = n;
    numbered->swap(other);
  }
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
  const auto map_of = [&](const Place& p) { return points_[p.index]->map; };
  if (!one_map) std::ranges::stable_sort(places, {}, map_of);
  const auto n = static_cast<Eigen::Index>(places.size());
  for (Eigen::ArrayXf* a : {&x_, &y_, &z_, &variance_}) a->resize(n);
  indices_.reserve(places.size());
  for (std::size_t first = 0; first < places.size();) {
    const MapId map = map_of(places[first]);
    std::size_t last = one_map ? places.size() : first;
    while (last < places.size() && map_of(places[last]) == map) ++last;
    box(std::span(places).subspan(first, last - first), map);
    first = last;
  }
}

PointsByPlace::Place PointsByPlace::place_of(const MapPoint& point, std::uint32_t index) {
  return {point.position.cast<float>(), static_cast<float>(point.covariance.trace()), index};
}

void PointsByPlace::hold(const Place& place) {
  const auto i = static_cast<Eigen::Index>(indices_.size());
  const Eigen::Vector3f& p = place.position;
  x_[i] = p.x();
  y_[i] = p.y();
  z_[i] = p.z();
  variance_[i] = place.variance;
  indices_.push_back(place.index);
  furthest_ = std::max(furthest_, p.cwiseAbs().maxCoeff());
}

void PointsByPlace::box(std::span<const Place> places, MapId map) {
  const Cells cells(places);
  std::vector<Numbered> order(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    order[i] = {cells.number_of(places[i].position), static_cast<std::uint32_t>(i)};
  }
  sort_by_number(&order);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Place& place = places[order[i].index];
    const Eigen::Vector3d position = place.position.cast<double>();
    if (i % kMostInBox == 0) boxes_.push_back({map, position, position, indices_.size(), indices_.size()});
    Box& box = boxes_.back();
    box.low = box.low.cwiseMin(position);
    box.high = box.high.cwiseMax(position);
    ++box.last;
    hold(place);
  }
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
      if (grid.any_near(px, radius.radius_px(variance_px2[i]) + slack_px[i], reach_px[i]))
        found.push_back(indices_[b.first + static_cast<std::size_t>(i)]);
    }
  }
  std::ranges::sort(found);
  std::vector<const MapPoint*> out;
  out.reserve(found.size());
  for (const std::uint32_t i : found) out.push_back(points_[i]);
  return out;
}

}  // namespace coslam
