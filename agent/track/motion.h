// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "agent/track/pyramid.h"

namespace coslam {

// Shift of the image content from one image to the next, as a whole, found by trying every shift of the coarsest level:
// it cannot be misled by a wrong start, and a fast turn of the camera is mostly a shift. Pixels of level 0.
Eigen::Vector2f global_shift(const Pyramid& from, const Pyramid& to);

// Tells which of the motions (at from, to) deviate from that of the image as a whole: from the affine motion that fits
// most of them, by far more than the others differ from it (what parallax does to all).
std::vector<bool> moves_apart(const std::vector<Eigen::Vector2f>& from_px, const std::vector<Eigen::Vector2f>& to_px);

// Mean squared difference of the middles (7 x 7) of two windows, (grey levels)^2.
float difference_of_middles(const PyramidLevel& a, const Eigen::Vector2f& a_px, const PyramidLevel& b,
                            const Eigen::Vector2f& b_px);

// Motions of tracks from one image to the next, asked for the motion at another place.
class MotionField {
 public:
  void add(const Eigen::Vector2f& at_px, const Eigen::Vector2f& motion_px) { samples_.push_back({at_px, motion_px}); }
  bool empty() const { return samples_.empty(); }
  std::size_t size() const { return samples_.size(); }
  // Median, in x and in y, of the motions of the five nearest. The field must not be empty.
  Eigen::Vector2f near(const Eigen::Vector2f& px);

 private:
  struct Sample {
    Eigen::Vector2f at_px, motion_px;
  };
  std::vector<Sample> samples_;
};

}  // namespace coslam
