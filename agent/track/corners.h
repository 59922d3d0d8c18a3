// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "agent/track/corner_score.h"
#include "agent/track/pyramid.h"

namespace coslam {

struct CornerConfig {
  int max_tracks = 300;
  float min_distance_px = 12;
  float min_eigenvalue = 1e-3f;  // relative to the strongest corner of recent images
  float border_px = 12;
};

// Finds new Shi-Tomasi corners in the emptiest cells of a grid, and evaluates only the cells that it needs. It looks at
// the image halved, where the noise of the camera makes no corners. A corner is weighed against the strongest of recent
// images or, so that dark parts get tracks too, against its own surroundings. Deterministic; thread-compatible.
class CornerFinder {
 public:
  explicit CornerFinder(const CornerConfig& config) : config_(config) {}

  // At most `wanted` corners, none closer than min_distance_px to another or to a live track. Where something moves
  // (moving_px: tracks that do) first, and denser. All places are pixels of level 0.
  const std::vector<Eigen::Vector2f>& find(const Pyramid& pyramid, const std::vector<Eigen::Vector2f>& live_px,
                                           const std::vector<Eigen::Vector2f>& moving_px, int wanted);

 private:
  // Below, all pixels are those of the level looked at.
  struct Candidate {
    Eigen::Vector2f px;
    float score;
  };
  struct Cell {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;   // pixels [x0, x1) x [y0, y1)
    std::vector<Eigen::Vector2f> tracks;  // in it, new ones included
    int rest_images = 0;                  // left before another look: nothing was found here
    bool moving = false;                  // something moves in it
    bool evaluated = false;
    std::vector<Candidate> candidates;  // best last
  };

  void lay_grid(const PyramidLevel& image);
  void clear_cells();
  std::size_t cell_index(const Eigen::Vector2f& px) const;
  void evaluate(Cell& cell);
  void keep_good(Cell& cell, float mean_score);
  bool has_room(const Eigen::Vector2f& px, bool moving) const;
  bool take_best(Cell& cell);
  bool serve(Cell& cell, std::size_t round);
  void serve_moving(std::size_t wanted);

  CornerConfig config_;
  const PyramidLevel* image_ = nullptr;  // during find()
  float scale_ = 1;                      // pixels of level 0 a pixel of it
  int image_cols_ = 0, image_rows_ = 0;
  int grid_cols_ = 0, grid_rows_ = 0;
  std::vector<Cell> cells_;
  std::size_t first_cell_ = 0;  // to be served, moves on from image to image
  std::vector<Eigen::Vector2f> found_px_;
  CornerScore score_;
  float strongest_ = 0;  // corner of recent images, (grey levels / pixel)^2
};

}  // namespace coslam
