// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <compare>
#include <cstdint>
#include <optional>
#include <vector>

#include "server/estimator/map/map.h"

// Finds the tracks of a camera near where a point should appear: for the stages that search for known points in images.
namespace coslam {

// Grid of one camera's tracks by image position.
class TrackGrid {
 public:
  struct InGrid {
    const ServerTrack* track = nullptr;
    Eigen::Vector2d px;          // undistorted
    Eigen::Matrix2d covariance;  // covariance in the image of the track's point
  };
  // Takes the tracks for which wanted(track) is true, or gives an optional covariance of the track, of which own_sigmas
  // standard deviations count.
  TrackGrid(const MapCamera& camera, auto&& wanted, double own_sigmas = 0) : own_variances_(own_sigmas * own_sigmas) {
    for (const auto& entry : camera.tracks) {
      const auto want = wanted(entry.second);
      if (want) add(entry.second, covariance_of(want));
    }
    sort();
  }
  // Visits the tracks in cells no farther than radius_px away, in x and in y.
  template <class Visit>
  void near(const Eigen::Vector2d& px, double radius_px, Visit visit) const {
    any_of_rows(px, radius_px, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) visit(tracks_[i].in);
      return false;
    });
  }
  // False: no track is within reach_px, widened by the track's own covariance. Reads one value for most places.
  bool may_reach(const Eigen::Vector2d& px, double reach_px) const { return reach_px > kFinePx || is_marked(px); }
  // True: a track is within reach_px of px, widened by the track's own covariance, and in cells no farther than
  // radius_px.
  bool any_near(const Eigen::Vector2d& px, double radius_px, double reach_px) const {
    const double reach2 = reach_px * reach_px;
    return any_of_rows(px, radius_px, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const InGrid& t = tracks_[i].in;
        if ((t.px - px).squaredNorm() <= reach2 + own_variances_ * t.covariance.trace()) return true;
      }
      return false;
    });
  }

 private:
  static constexpr double kCellPx = 16, kFinePx = 8;
  struct Cell {
    int y = 0, x = 0;
    friend auto operator<=>(const Cell&, const Cell&) = default;
  };
  struct InCell {
    Cell cell;
    InGrid in;
  };
  static Eigen::Matrix2d covariance_of(bool) { return Eigen::Matrix2d::Zero(); }
  static const Eigen::Matrix2d& covariance_of(const std::optional<Eigen::Matrix2d>& covariance) { return *covariance; }
  static Cell cell(const Eigen::Vector2d& px) { return {floor_of(px.y() / kCellPx), floor_of(px.x() / kCellPx)}; }
  static int floor_of(double x) {
    const int whole = static_cast<int>(x);
    return whole - static_cast<int>(x < whole);
  }
  void add(const ServerTrack& t, const Eigen::Matrix2d& covariance) {
    const Eigen::Vector2d px = t.seen.back().undistorted_px.cast<double>();
    tracks_.push_back({cell(px), {&t, px, covariance}});
  }
  void sort() {
    std::ranges::stable_sort(tracks_, {}, &InCell::cell);
    if (tracks_.empty()) return;
    low_ = high_ = tracks_.front().cell;
    high_.y = tracks_.back().cell.y;
    for (const InCell& t : tracks_) {
      low_.x = std::min(low_.x, t.cell.x);
      high_.x = std::max(high_.x, t.cell.x);
    }
    std::size_t at = 0;
    for (int y = low_.y; y <= high_.y; ++y) {
      for (int x = low_.x; x <= high_.x + 1; ++x) {
        while (at < tracks_.size() && tracks_[at].cell < Cell{y, x}) ++at;
        begins_.push_back(at);
      }
    }
    mark();
  }
  double own_px(const InGrid& t) const { return std::sqrt(own_variances_ * t.covariance.trace()); }
  // Marks the fine cells that a track may be near to, within kFinePx widened by its own covariance.
  void mark() {
    Eigen::Array2d low = tracks_.front().in.px, high = low;
    for (const InCell& t : tracks_) {
      const double most_px = kFinePx + own_px(t.in);
      low = low.min(t.in.px.array() - most_px);
      high = high.max(t.in.px.array() + most_px);
    }
    origin_px_ = low - kFinePx;
    const Eigen::Array2i size = ((high - origin_px_) / kFinePx).cast<int>() + 2;
    columns_ = size.x();
    rows_ = size.y();
    marked_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), false);
    for (const InCell& t : tracks_) {
      const double most_px = kFinePx + own_px(t.in);
      const Eigen::Array2d at = t.in.px.array() - origin_px_;
      const Eigen::Array2i from = ((at - most_px) / kFinePx).cast<int>(), to = ((at + most_px) / kFinePx).cast<int>();
      for (int y = from.y(); y <= to.y(); ++y) {
        for (int x = from.x(); x <= to.x(); ++x) marked_[fine(x, y)] = true;
      }
    }
  }
  std::size_t fine(int x, int y) const { return static_cast<std::size_t>(y * columns_ + x); }
  bool is_marked(const Eigen::Vector2d& px) const {
    if (marked_.empty()) return false;
    const Eigen::Array2d at = (px.array() - origin_px_) / kFinePx;
    if (!((at >= 0).all() && at.x() < columns_ && at.y() < rows_)) return false;
    return marked_[fine(static_cast<int>(at.x()), static_cast<int>(at.y()))] != 0;
  }
  std::size_t begin_of(int y, int x) const {
    return begins_[static_cast<std::size_t>((y - low_.y) * (high_.x - low_.x + 2) + x - low_.x)];
  }
  // Calls holds(first, last) with each row of cells, as a range of tracks_ (last exclusive), until it returns true.
  bool any_of_rows(const Eigen::Vector2d& px, double radius_px, auto&& holds) const {
    if (tracks_.empty()) return false;
    const Cell low = cell(px - Eigen::Vector2d::Constant(radius_px)),
               high = cell(px + Eigen::Vector2d::Constant(radius_px));
    const int left = std::max(low.x, low_.x), right = std::min(high.x, high_.x);
    if (left > right) return false;
    for (int y = std::max(low.y, low_.y); y <= std::min(high.y, high_.y); ++y) {
      if (holds(begin_of(y, left), begin_of(y, right + 1))) return true;
    }
    return false;
  }

  std::vector<InCell> tracks_;       // sorted by cell
  Cell low_, high_;                  // bounds of the cells that hold tracks
  std::vector<std::size_t> begins_;  // first track of each cell, from low_ on and one column more
  double own_variances_;
  Eigen::Array2d origin_px_ = Eigen::Array2d::Zero();  // corner of the fine cells
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint8_t> marked_;
};

inline constexpr double kMostSearch_px = 40;  // largest distance from where a point should be
// Margin around the image that undistorted pixels may lie in.
inline Eigen::Vector2d search_margin_px(const CameraModel& camera) {
  return 0.3 * Eigen::Vector2d(camera.width_px, camera.height_px);
}

// Radius around a point's projection in which it is searched for.
struct SearchRadius {
  double sigmas = 0, noise_px = 0;  // sigma of the image position of a point and a track together
  double least_px = 0, most_px = kMostSearch_px;
  // Radius for a variance of the point's image position, both directions together.
  double radius_px(double variance_px2) const {
    return std::clamp(sigmas * std::sqrt(variance_px2 + noise_px * noise_px), least_px, most_px);
  }
  // Bound on the distance of a matching track, without and by its own variance: squared, reach2_px2 + variances *
  // variance_px2. Noise is of raw pixels, which a lens may have drawn together.
  double variances() const { return sigmas * sigmas; }
  double reach2_px2() const {
    constexpr double kLeastScale = 0.5;
    return sigmas == 0 ? most_px * most_px : variances() * std::pow(noise_px / kLeastScale, 2);
  }
};

// Projection of a point and its search radius; empty far outside the image and when the point is too uncertain to be
// told from its neighbours.
struct SearchWindow {
  Eigen::Vector2d px;
  Eigen::Matrix2d covariance;  // covariance of px due to the point's covariance
  double radius_px = 0;
};

inline std::optional<SearchWindow> search_window(const CameraModel& camera, const Rigid3& cam_from_world,
                                                 const MapPoint& p, double gate_px, double theta) {
  const Eigen::Vector2d margin_px = search_margin_px(camera);
  SearchWindow w;
  if (!project_world(camera, cam_from_world, p.position, &w.px)) return std::nullopt;
  if (w.px.x() < -margin_px.x() || w.px.x() > camera.width_px + margin_px.x() || w.px.y() < -margin_px.y() ||
      w.px.y() > camera.height_px + margin_px.y()) {
    return std::nullopt;
  }
  Eigen::Matrix<double, 2, 3> j;  // derivative only here: most points are out of sight
  project_world(camera, cam_from_world, p.position, &w.px, &j);
  w.covariance = j * p.covariance * j.transpose();
  w.radius_px = theta * std::sqrt(w.covariance.trace() + gate_px * gate_px);
  return w.radius_px > kMostSearch_px ? std::nullopt : std::optional(w);
}

// Returns static points seen lately, which cameras may find again.
inline std::vector<const MapPoint*> recent_static_points(const Map& map) {
  std::vector<const MapPoint*> out = map.recent_points();
  std::erase_if(out, [](const MapPoint* p) { return !p->rests(); });
  return out;
}

}  // namespace coslam
