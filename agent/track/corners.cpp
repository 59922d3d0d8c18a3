// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/corners.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace coslam {
namespace {

constexpr int kTracksPerCell = 2;      // in a full, even image
constexpr int kBarrenRest_images = 5;  // a cell without corners is not looked at again at once
constexpr std::size_t kMostCandidates = 12;
constexpr float kStrongestDecay = 0.995f;  // an image
// Noise of 2 grey levels gives a score of about 0.6; a corner must stand out of that.
constexpr float kNoiseScore = 0.6f;
// A corner this many times above the mean score of its cell is distinct, however dark the cell.
constexpr float kDistinct = 6.0f;

// Vertex of the parabola through three values around a maximum, -0.5 to 0.5.
float peak_offset(float before, float at, float after) {
  const float curvature = before - 2 * at + after;
  return curvature < 0 ? std::clamp(0.5f * (before - after) / curvature, -0.5f, 0.5f) : 0.0f;
}

// Strictly above the neighbours that come first, so that of equal ones exactly one is a maximum.
bool is_maximum(const CornerScore& score, int x, int y) {
  const float* up = score.row(y - 1) + x;
  const float* row = score.row(y) + x;
  const float* down = score.row(y + 1) + x;
  const float s = row[0];
  return s > up[-1] && s > up[0] && s > up[1] && s > row[-1] && s >= row[1] && s >= down[-1] && s >= down[0] &&
         s >= down[1];
}

}  // namespace

void CornerFinder::lay_grid(const PyramidLevel& image) {
  if (image.cols() == image_cols_ && image.rows() == image_rows_) return;
  image_cols_ = image.cols();
  image_rows_ = image.rows();
  const float area = static_cast<float>(image_cols_) * static_cast<float>(image_rows_);
  const float side = std::sqrt(area * kTracksPerCell / static_cast<float>(std::max(1, config_.max_tracks)));
  // Neighbouring cells must hold all that is closer than min_distance_px, see has_room().
  const float cell_px = std::max({side, config_.min_distance_px, 8.0f});
  grid_cols_ = std::max(1, static_cast<int>(static_cast<float>(image_cols_) / cell_px));
  grid_rows_ = std::max(1, static_cast<int>(static_cast<float>(image_rows_) / cell_px));
  const int border = static_cast<int>(std::ceil(config_.border_px));
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

std::size_t CornerFinder::cell_index(const Eigen::Vector2f& px) const {
  const int column = static_cast<int>(px.x() + 0.5f) * grid_cols_ / image_cols_;
  const int row = static_cast<int>(px.y() + 0.5f) * grid_rows_ / image_rows_;
  return static_cast<std::size_t>(std::clamp(row, 0, grid_rows_ - 1) * grid_cols_ +
                                  std::clamp(column, 0, grid_cols_ - 1));
}

void CornerFinder::evaluate(const PyramidLevel& image, Cell& cell) {
  cell.evaluated = true;
  cell.candidates.clear();
  const int cols = cell.x1 - cell.x0, rows = cell.y1 - cell.y0;
  if (cols <= 0 || rows <= 0) return;
  score_.compute(image, cell.x0 - 1, cell.y0 - 1, cols + 2, rows + 2);
  double total = 0;
  for (int y = 1; y <= rows; ++y) {
    for (int x = 1; x <= cols; ++x) {
      const float s = score_.row(y)[x];
      total += s;
      if (s < kNoiseScore || !is_maximum(score_, x, y)) continue;
      const float dx = peak_offset(score_.row(y)[x - 1], s, score_.row(y)[x + 1]);
      const float dy = peak_offset(score_.row(y - 1)[x], s, score_.row(y + 1)[x]);
      cell.candidates.push_back(
          {{static_cast<float>(cell.x0 - 1 + x) + dx, static_cast<float>(cell.y0 - 1 + y) + dy}, s});
    }
  }
  for (const Candidate& c : cell.candidates) strongest_ = std::max(strongest_, c.score);
  const float distinct = kDistinct * static_cast<float>(total) / static_cast<float>(cols * rows);
  const float least = std::min(config_.min_eigenvalue * strongest_, distinct);
  std::erase_if(cell.candidates, [&](const Candidate& c) { return c.score < least; });
  std::stable_sort(cell.candidates.begin(), cell.candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
  if (cell.candidates.size() > kMostCandidates) {
    cell.candidates.erase(cell.candidates.begin(), cell.candidates.end() - kMostCandidates);
  }
}

bool CornerFinder::has_room(const Eigen::Vector2f& px) const {
  const float closest = config_.min_distance_px * config_.min_distance_px;
  const int index = static_cast<int>(cell_index(px)), column = index % grid_cols_, row = index / grid_cols_;
  for (int r = std::max(0, row - 1); r <= std::min(grid_rows_ - 1, row + 1); ++r) {
    for (int c = std::max(0, column - 1); c <= std::min(grid_cols_ - 1, column + 1); ++c) {
      for (const Eigen::Vector2f& other : cells_[static_cast<std::size_t>(r * grid_cols_ + c)].tracks) {
        if ((other - px).squaredNorm() < closest) return false;
      }
    }
  }
  return true;
}

bool CornerFinder::take_best(const PyramidLevel& image, Cell& cell) {
  if (!cell.evaluated) evaluate(image, cell);
  while (!cell.candidates.empty()) {
    const Eigen::Vector2f px = cell.candidates.back().px;
    cell.candidates.pop_back();
    if (!has_room(px)) continue;
    found_px_.push_back(px);
    cells_[cell_index(px)].tracks.push_back(px);
    return true;
  }
  return false;
}

const std::vector<Eigen::Vector2f>& CornerFinder::find(const PyramidLevel& image,
                                                       const std::vector<Eigen::Vector2f>& live_px, int wanted) {
  lay_grid(image);
  found_px_.clear();
  strongest_ *= kStrongestDecay;
  for (Cell& cell : cells_) {
    cell.tracks.clear();
    cell.evaluated = false;
    cell.candidates.clear();
  }
  for (const Eigen::Vector2f& px : live_px) cells_[cell_index(px)].tracks.push_back(px);
  // Rounds: cells with no track, then those with one, and so on, so that the emptiest are served first.
  for (std::size_t round = 0; static_cast<int>(found_px_.size()) < wanted; ++round) {
    bool any_left = false;
    for (Cell& cell : cells_) {
      if (static_cast<int>(found_px_.size()) >= wanted) break;
      if (cell.rest_images > 0) {
        if (round == 0) --cell.rest_images;
        continue;
      }
      if (cell.tracks.size() > round) {
        any_left = true;
        continue;
      }
      if (take_best(image, cell)) {
        any_left = true;
      } else {
        cell.rest_images = kBarrenRest_images;
      }
    }
    if (!any_left) break;
  }
  return found_px_;
}

}  // namespace coslam
