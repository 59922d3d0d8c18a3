// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

#include "agent/track/cell_corners.h"

namespace coslam {

struct CornerConfig {
  int max_tracks = 300;
  float min_distance_px = 12;
  float min_eigenvalue = 1e-3f;  // relative to the strongest corner of recent images
  float border_px = 12;
  float free_share = 1;  // share of the image where corners may be; it gets as many tracks, closer together
};

// Finds new Shi-Tomasi corners in the emptiest cells of a grid, and looks only into the cells that it needs. A corner
// is weighed against the strongest of recent images or, so that dark parts get tracks too, against its own
// surroundings. Deterministic; thread-compatible.
class CornerFinder {
 public:
  // The level is that of the pyramid that is looked at; the size that of the image.
  CornerFinder(const CornerConfig& config, int image_cols, int image_rows, int level);

  // The grid, pixels of the level.
  std::vector<CornerCell> cells() const;

  // Finds at most `wanted` corners, none closer than min_distance_px to another or to a live track. Where something
  // moves (moving_px: tracks that do) first, and denser. All places are pixels of level 0. look_in gives what is in the
  // cell of an index of cells().
  using LookIn = std::function<CellCorners(std::size_t cell)>;
  const std::vector<Eigen::Vector2f>& find(const LookIn& look_in, const std::vector<Eigen::Vector2f>& live_px,
                                           const std::vector<Eigen::Vector2f>& moving_px, int wanted);

 private:
  // A cell of the grid; all pixels here are those of the level looked at.
  struct Cell {
    std::vector<Eigen::Vector2f> tracks;  // in it, new ones included
    int rest_images = 0;                  // left before another look: nothing was found here
    bool moving = false;                  // something moves in it
    bool evaluated = false;
    std::vector<Corner> candidates;  // best last
  };

  void clear_cells();
  std::size_t cell_index(const Eigen::Vector2f& px) const;
  void evaluate(std::size_t index, const LookIn& look_in);
  bool has_room(const Eigen::Vector2f& px, bool moving) const;
  bool take_best(std::size_t index, const LookIn& look_in);
  bool serve(std::size_t index, std::size_t round, const LookIn& look_in);
  void serve_moving(std::size_t wanted, const LookIn& look_in);

  CornerConfig config_;
  float scale_;  // pixels of level 0 a pixel of it
  int image_cols_, image_rows_;
  int grid_cols_ = 0, grid_rows_ = 0;
  std::vector<Cell> cells_;
  std::size_t first_cell_ = 0;  // to be served, moves on from image to image
  std::vector<Eigen::Vector2f> found_px_;
  float strongest_ = 0;  // corner of recent images, (grey levels / pixel)^2
};

}  // namespace coslam
