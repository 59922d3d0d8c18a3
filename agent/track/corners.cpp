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
constexpr float kMovingDistance = 0.6f;  // of min_distance_px
constexpr int kBarrenRest_images = 5;    // a cell without corners is not looked at again at once
constexpr std::size_t kMostCandidates = 12;
constexpr float kStrongestDecay = 0.995f;  // an image
// Noise of 4 grey levels gives scores of 0.2 to 0.7 in the halved image. A corner must stand well out of that, or,
// where the image is dark and therefore calm, be distinct: so many times above the mean score of its cell as noise
// never is.
constexpr float kSureScore = 2.5f;
constexpr float kLeastScore = 0.3f;
constexpr float kDistinct = 4.5f;

// Vertex of the parabola through three values around a maximum, -0.5 to 0.5.
float peak_offset(float before, float at, float after) {
  const float curvature = before - 2 * at + after;
  return curvature < 0 ? std::clamp(0.5f * (before - after) / curvature, -0.5f, 0.5f) : 0.0f;
}

// Of equal neighbours exactly one is the maximum: strictly above those that come first.
bool is_maximum(const CornerScore& score, int x, int y) {
  const float* up = score.row(y - 1) + x;
  const float* row = score.row(y) + x;
  const float* down = score.row(y + 1) + x;
  const float s = row[0];
  return s > up[-1] && s > up[0] && s > up[1] && s > row[-1] && s >= row[1] && s >= down[-1] && s >= down[0] &&
         s >= down[1];
}

Eigen::Vector2f sub_pixel(const CornerScore& score, int x, int y) {
  const float s = score.row(y)[x];
  return {static_cast<float>(x) + peak_offset(score.row(y)[x - 1], s, score.row(y)[x + 1]),
          static_cast<float>(y) + peak_offset(score.row(y - 1)[x], s, score.row(y + 1)[x])};
}

}  // namespace

void CornerFinder::lay_grid(const PyramidLevel& image) {
  image_ = &image;
  if (image.cols() == image_cols_ && image.rows() == image_rows_) return;
  image_cols_ = image.cols();
  image_rows_ = image.rows();
  const float area = static_cast<float>(image_cols_) * static_cast<float>(image_rows_);
  const float side = std::sqrt(area * kTracksPerCell / static_cast<float>(std::max(1, config_.max_tracks)));
  // Neighbouring cells must hold all that is closer than min_distance_px, see has_room().
  const float cell_px = std::max({side, config_.min_distance_px / scale_, 8.0f});
  grid_cols_ = std::max(1, static_cast<int>(static_cast<float>(image_cols_) / cell_px));
  grid_rows_ = std::max(1, static_cast<int>(static_cast<float>(image_rows_) / cell_px));
  const int border = static_cast<int>(std::ceil(config_.border_px / scale_));
  cells_.assign(static_cast<std::size_t>(grid_cols_ * grid_rows_), Cell());
  for (int i = 0; i < grid_cols_ * grid_rows_; ++i) {
    Cell& cell = cells_[static_cast<std::size_t>(i)];
    const int column = i % grid_cols_, row = i / grid_cols_;
    cell.x0 = std::max(border, column * image_cols_ / grid_cols_);
    cell.x1 = std::min(image_cols_ - border, (column + 1) * image_cols_ / grid_cols_);
    cell.y0 = std::max(border, row * image_rows_ / grid_rows_);
    cell.y1 = std::min(image_rows_ - border, (row + 1) * image_rows_ / grid_rows_);
  }
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

void CornerFinder::evaluate(Cell& cell) {
  cell.evaluated = true;
  const int cols = cell.x1 - cell.x0, rows = cell.y1 - cell.y0;
  if (cols <= 0 || rows <= 0) return;
  const int x0 = cell.x0 - 1, y0 = cell.y0 - 1;  // a maximum needs its neighbours
  score_.compute(*image_, x0, y0, cols + 2, rows + 2);
  float total = 0;
  for (int y = 1; y <= rows; ++y) {
    for (int x = 1; x <= cols; ++x) {
      const float s = score_.row(y)[x];
      total += s;
      if (s < kLeastScore || !is_maximum(score_, x, y)) continue;
      const Eigen::Vector2f origin(static_cast<float>(x0), static_cast<float>(y0));
      cell.candidates.push_back({origin + sub_pixel(score_, x, y), s});
      strongest_ = std::max(strongest_, s);
    }
  }
  keep_good(cell, total / static_cast<float>(cols * rows));
}

void CornerFinder::keep_good(Cell& cell, float mean_score) {
  const float least = std::min(std::max(config_.min_eigenvalue * strongest_, kSureScore), kDistinct * mean_score);
  std::erase_if(cell.candidates, [&](const Candidate& c) { return c.score < least; });
  std::stable_sort(cell.candidates.begin(), cell.candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
  if (cell.candidates.size() > kMostCandidates) {
    cell.candidates.erase(cell.candidates.begin(), cell.candidates.end() - kMostCandidates);
  }
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

bool CornerFinder::take_best(Cell& cell) {
  if (!cell.evaluated) evaluate(cell);
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
bool CornerFinder::serve(Cell& cell, std::size_t round) {
  if (cell.rest_images > 0) return false;
  if (cell.tracks.size() > round || take_best(cell)) return true;
  cell.rest_images = kBarrenRest_images;
  return false;
}

void CornerFinder::serve_moving(std::size_t wanted) {
  for (std::size_t round = 0; round < kMovingTracksPerCell; ++round) {
    for (Cell& cell : cells_) {
      if (found_px_.size() >= wanted) return;
      if (cell.moving) serve(cell, round);
    }
  }
}

const std::vector<Eigen::Vector2f>& CornerFinder::find(const Pyramid& pyramid,
                                                       const std::vector<Eigen::Vector2f>& live_px,
                                                       const std::vector<Eigen::Vector2f>& moving_px, int wanted) {
  const int level = std::min(1, pyramid.levels() - 1);
  scale_ = static_cast<float>(1 << level);
  lay_grid(pyramid.level(level));
  clear_cells();
  found_px_.clear();
  strongest_ *= kStrongestDecay;
  if (4 * live_px.size() < static_cast<std::size_t>(config_.max_tracks)) {
    for (Cell& cell : cells_) cell.rest_images = 0;  // too few tracks to be choosy: the image may just have come back
  }
  for (const Eigen::Vector2f& px : live_px) cells_[cell_index(px / scale_)].tracks.emplace_back(px / scale_);
  for (const Eigen::Vector2f& px : moving_px) cells_[cell_index(px / scale_)].moving = true;
  serve_moving(static_cast<std::size_t>(wanted));
  // Rounds: cells with no track, then those with one, and so on. The cells of a round in an order that favours no part
  // of the image when only a few corners are wanted.
  std::size_t stride = cells_.size() * 5 / 8 + 1;
  while (std::gcd(stride, cells_.size()) != 1) ++stride;
  bool any_left = true;
  for (std::size_t round = 0; any_left && static_cast<int>(found_px_.size()) < wanted; ++round) {
    any_left = false;
    for (std::size_t i = 0; i < cells_.size() && static_cast<int>(found_px_.size()) < wanted; ++i) {
      if (serve(cells_[(first_cell_ + i * stride) % cells_.size()], round)) any_left = true;
    }
  }
  first_cell_ = (first_cell_ + 1) % cells_.size();
  return found_px_;
}

}  // namespace coslam
