// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "server/estimator/covisibility/grouping.h"

// Tracks of two cameras that may be of one thing: for the stages that make points from two cameras at one instant.
namespace coslam {

struct PairMatchConfig {
  double seed_radius = 0.10;    // phi_r, as a share of the larger image side
  double disparity_gate = 3.0;  // phi_d over phi_r
};

struct Feature {
  const ServerTrack* track;
  Eigen::Vector2d px;
};

// Point that both cameras see.
struct Seed {
  Eigen::Vector2d in_first, disparity;
};

// Pair of cameras at one set.
struct PairView {
  const MapCamera* first;
  const MapCamera* second;
  Rigid3 first_pose, second_pose;
  Eigen::Matrix3d fundamental;  // line in second = F * (pixel in first)
  std::vector<Seed> seeds;
};

// Makes the view of two cameras with a pose, at one instant.
PairView make_pair_view(const Map& map, const ViewEdge& edge, const Rigid3& first_pose, const Rigid3& second_pose);
// True when the camera has a pose in this set.
bool has_pose_now(const CameraFrames& c, const FrameSet& set);
// Half width of the epipolar band, in pixels.
double band_px_of(const Map& map, const PairView& view);
// Disparity of the nearest point that both cameras see, if one is near.
std::optional<Eigen::Vector2d> expected_disparity(const PairView& view, const Eigen::Vector2d& px, double radius_px);

struct Score {
  int best = -1;
  double first = -2, second = -2;
  void offer(int index, double value) {
    if (value > first) {
      second = first;
      first = value;
      best = index;
    } else {
      second = std::max(second, value);
    }
  }
};

// Scores, by the likeness of their patches, pairs of tracks on each other's epipolar line; keeps the best per feature
// on both sides.
class PairScores {
 public:
  PairScores(const PairView& view, const std::vector<Feature>& a, const std::vector<Feature>& b, double band_px,
             const PairMatchConfig& config, double zncc_min)
      : of_a(a.size()),
        of_b(b.size()),
        view_(view),
        a_(a),
        b_(b),
        band_px_(band_px),
        config_(config),
        zncc_min_(zncc_min) {
    for (const Feature& f : a) {
      const Eigen::Vector3d line = view.fundamental * f.px.homogeneous();
      lines_.emplace_back(line / std::max(1e-12, line.head<2>().norm()));
      disparities_.push_back(expected_disparity(view, f.px, radius_px()));
    }
  }

  // Scores pairs that may join; then, for features with a good score, also pairs that may not join, because these
  // compete.
  void score(auto&& may_join, auto&& alike) {
    for_all([&](std::size_t i, std::size_t j) {
      if (may_join(a_[i], b_[j])) offer(i, j, alike);
    });
    const auto good = [&](const Score& s) { return s.first >= zncc_min_; };
    std::vector<bool> row(a_.size()), column(b_.size());
    std::transform(of_a.begin(), of_a.end(), row.begin(), good);
    std::transform(of_b.begin(), of_b.end(), column.begin(), good);
    for_all([&](std::size_t i, std::size_t j) {
      if ((row[i] || column[j]) && !may_join(a_[i], b_[j])) offer(i, j, alike);
    });
  }

  std::vector<Score> of_a, of_b;
  int compared = 0;

 private:
  double radius_px() const {
    return config_.seed_radius * std::max(view_.first->model.width_px, view_.first->model.height_px);
  }
  void for_all(auto&& visit) const {
    for (std::size_t i = 0; i < a_.size(); ++i) {
      for (std::size_t j = 0; j < b_.size(); ++j) visit(i, j);
    }
  }
  void offer(std::size_t i, std::size_t j, auto&& alike) {
    if (std::abs(lines_[i].dot(b_[j].px.homogeneous())) > band_px_) return;
    const auto& disparity = disparities_[i];
    if (disparity && (b_[j].px - a_[i].px - *disparity).norm() > config_.disparity_gate * radius_px()) return;
    ++compared;
    const double s = alike(a_[i], b_[j]);
    of_a[i].offer(static_cast<int>(j), s);
    of_b[j].offer(static_cast<int>(i), s);
  }

  const PairView& view_;
  const std::vector<Feature>&a_, &b_;
  double band_px_;
  const PairMatchConfig& config_;
  double zncc_min_;
  std::vector<Eigen::Vector3d> lines_;  // epipolar lines in the second image, with unit normals
  std::vector<std::optional<Eigen::Vector2d>> disparities_;
};

struct PairMatchCounts {
  int compared = 0, matched = 0;
};

// Joins pairs of tracks that look most like each other, and clearly so, among those on each other's epipolar line that
// the nearest shared points allow. Returns the number of pairs joined.
int best_pairs(const Map& map, const PairView& view, const std::vector<Feature>& a, const std::vector<Feature>& b,
               double band_px, const PairMatchConfig& config, auto&& may_join, auto&& alike, PairMatchCounts* counts,
               auto&& join) {
  const double zncc_min = map.config().zncc_min, margin = map.config().zncc_margin;
  PairScores scores(view, a, b, band_px, config, zncc_min);
  scores.score(may_join, alike);
  counts->compared += scores.compared;
  int joined = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Score& s = scores.of_a[i];
    if (s.best < 0 || s.first < zncc_min || s.first - s.second < margin) continue;
    const Score& back = scores.of_b[static_cast<std::size_t>(s.best)];
    if (back.best != static_cast<int>(i) || back.first - back.second < margin) continue;
    const Feature& other = b[static_cast<std::size_t>(s.best)];
    if (!may_join(a[i], other)) continue;
    ++counts->matched;
    joined += join(a[i], other) ? 1 : 0;
  }
  return joined;
}

}  // namespace coslam
