// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/corners.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace coslam {
namespace {

constexpr int kTracksPerCell = 2;  // in a full, even image
// What moves is seen for a short while, turns, and swings its arms in front: more and closer tracks where it is.
constexpr std::size_t kMovingTracksPerCell = 6;
constexpr float kMovingDistance = 0.6f;    // of min_distance_px
constexpr int kBarrenRest_images = 5;      // a cell without corners is not looked at again at once
constexpr float kStrongestDecay = 0.995f;  // an image
// A corner must stand well out of what noise scores (see kLeastCornerScore), or, where the image is dark and therefore
// calm, be distinct: so many times above the mean score of its cell as noise never is.
constexpr float kSureScore = 2.5f;
constexpr float kDistinct = 4.5f;

}  // namespace

CornerFinder::CornerFinder(const CornerConfig& config, int image_cols, int image_rows, int level)
    : config_(config),
      scale_(static_cast<float>(1 << level)),
      image_cols_((image_cols + (1 << level) - 1) >> level),
      image_rows_((image_rows + (1 << level) - 1) >> level) {
  config_.min_distance_px *= std::sqrt(config_.free_share);
  const float area = static_cast<float>(image_cols_) * static_cast<float>(image_rows_);
  const float side = std::sqrt(area * kTracksPerCell / static_cast<float>(std::max(1, config_.max_tracks)));
  // Neighbouring cells must hold all that is closer than min_distance_px, see has_room().
  const float cell_px = std::max({side, config_.min_distance_px / scale_, 8.0f});
  grid_cols_ = std::max(1, static_cast<int>(static_cast<float>(image_cols_) / cell_px));
  grid_rows_ = std::max(1, static_cast<int>(static_cast<float>(image_rows_) / cell_px));
  cells_.resize(static_cast<std::size_t>(grid_cols_ * grid_rows_));
}

std::vector<CornerCell> CornerFinder::cells() const {
  const int border = static_cast<int>(std::ceil(config_.border_px / scale_));
  std::vector<CornerCell> out;
  for (int i = 0; i < grid_cols_ * grid_rows_; ++i) {
    const int column = i % grid_cols_, row = i / grid_cols_;
    out.push_back({std::max(border, column * image_cols_ / grid_cols_),
                   std::max(border, row * image_rows_ / grid_rows_),
                   std::min(image_cols_ - border, (column + 1) * image_cols_ / grid_cols_),
                   std::min(image_rows_ - border, (row + 1) * image_rows_ / grid_rows_)});
  }
  return out;
}

void CornerFinder::clear_cells() {
  for (Cell& cell : cells_) {
    cell.tracks.clear();
    cell.candidates.clear();
    cell.evaluated = false;
    cell.moving = false;
    if (cell.rest_images > 0) --cell.rest_images;
  }
}

std::size_t CornerFinder::cell_index(const Eigen::Vector2f& px) const {
  const int column = std::clamp(static_cast<int>(px.x() + 0.5f) * grid_cols_ / image_cols_, 0, grid_cols_ - 1);
  const int row = std::clamp(static_cast<int>(px.y() + 0.5f) * grid_rows_ / image_rows_, 0, grid_rows_ - 1);
  return static_cast<std::size_t>(row * grid_cols_ + column);
}

void CornerFinder::evaluate(std::size_t index, const LookIn& look_in) {
  Cell& cell = cells_[index];
  const CellCorners seen = look_in(index);
  cell.evaluated = true;
  cell.candidates = seen.corners;
  if (cell.candidates.empty()) return;
  strongest_ = std::max(strongest_, cell.candidates.back().score);
  const float least = std::min(std::max(config_.min_eigenvalue * strongest_, kSureScore), kDistinct * seen.mean_score);
  std::erase_if(cell.candidates, [&](const Corner& c) { return c.score < least; });
}

bool CornerFinder::has_room(const Eigen::Vector2f& px, bool moving) const {
  const float distance = (moving ? kMovingDistance : 1.0f) * config_.min_distance_px / scale_;
  const int index = static_cast<int>(cell_index(px)), column = index % grid_cols_, row = index / grid_cols_;
  for (int r = std::max(0, row - 1); r <= std::min(grid_rows_ - 1, row + 1); ++r) {
    for (int c = std::max(0, column - 1); c <= std::min(grid_cols_ - 1, column + 1); ++c) {
      for (const Eigen::Vector2f& other : cells_[static_cast<std::size_t>(r * grid_cols_ + c)].tracks) {
        if ((other - px).squaredNorm() < distance * distance) return false;
      }
    }
  }
  return true;
}

bool CornerFinder::take_best(std::size_t index, const LookIn& look_in) {
  Cell& cell = cells_[index];
  if (!cell.evaluated) evaluate(index, look_in);
  while (!cell.candidates.empty()) {
    const Eigen::Vector2f px = cell.candidates.back().px;
    cell.candidates.pop_back();
    if (!has_room(px, cell.moving)) continue;
    found_px_.emplace_back(px * scale_);
    cells_[cell_index(px)].tracks.push_back(px);
    return true;
  }
  return false;
}

// Gives a cell with no more than `round` tracks one more. False when the cell has nothing more to give.
bool CornerFinder::serve(std::size_t index, std::size_t round, const LookIn& look_in) {
  Cell& cell = cells_[index];
  if (cell.rest_images > 0) return false;
  if (cell.tracks.size() > round || take_best(index, look_in)) return true;
  cell.rest_images = kBarrenRest_images;
  return false;
}

void CornerFinder::serve_moving(std::size_t wanted, const LookIn& look_in) {
  for (std::size_t round = 0; round < kMovingTracksPerCell; ++round) {
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      if (found_px_.size() >= wanted) return;
      if (cells_[i].moving) serve(i, round, look_in);
    }
  }
}

const std::vector<Eigen::Vector2f>& CornerFinder::find(const LookIn& look_in,
                                                       const std::vector<Eigen::Vector2f>& live_px,
                                                       const std::vector<Eigen::Vector2f>& moving_px, int wanted) {
  clear_cells();
  found_px_.clear();
  strongest_ *= kStrongestDecay;
  if (4 * live_px.size() < static_cast<std::size_t>(config_.max_tracks)) {
    for (Cell& cell : cells_) cell.rest_images = 0;  // too few tracks to be choosy: the image may just have come back
  }
  for (const Eigen::Vector2f& px : live_px) cells_[cell_index(px / scale_)].tracks.emplace_back(px / scale_);
  for (const Eigen::Vector2f& px : moving_px) cells_[cell_index(px / scale_)].moving = true;
  serve_moving(static_cast<std::size_t>(wanted), look_in);
  // Rounds: cells with no track, then those with one, and so on. The cells of a round in an order that favours no part
  // of the image when only a few corners are wanted.
  std::size_t stride = cells_.size() * 5 / 8 + 1;
  while (std::gcd(stride, cells_.size()) != 1) ++stride;
  bool any_left = true;
  for (std::size_t round = 0; any_left && static_cast<int>(found_px_.size()) < wanted; ++round) {
    any_left = false;
    for (std::size_t i = 0; i < cells_.size() && static_cast<int>(found_px_.size()) < wanted; ++i) {
      if (serve((first_cell_ + i * stride) % cells_.size(), round, look_in)) any_left = true;
    }
  }
  first_cell_ = (first_cell_ + 1) % cells_.size();
  return found_px_;
}

}  // namespace coslam
