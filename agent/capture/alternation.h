// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <opencv2/core/mat.hpp>

namespace coslam {

// A camera that takes its images in turn at two or three settings: bracketed exposures, a projector of dots that is on
// in every second one, left and right of a pair as one stream. An image is then far more like the one two (or three)
// before it than like the one before, which motion never does. Images of one setting are used: of that with the most
// contrast or, where all have about the same, of the darkest one, which has no dots. Pure; for one thread.
class Alternation {
 public:
  // Of each image in their order the means of its blocks, and by how much neighbouring pixels differ: dots that are
  // projected change little else. True: it is of a setting that is not used.
  bool leaves_out(const cv::Mat& blocks, double step);

 private:
  static constexpr std::size_t kMostSettings = 3, kMostBack = 2 * kMostSettings - 1, kWindow = 16;
  using Changes = std::array<double, kMostBack>;  // against the 1, 2, ... before, grey values
  struct Seen {
    cv::Mat blocks;
    double step = 0, mean = 0, contrast = 0;  // grey values
    Changes of_blocks{}, of_step{};
    bool used = true;
  };
  void note_settings();
  std::size_t settings_by(Changes Seen::*changes, double least_change) const;
  void choose(std::size_t settings);

  std::deque<Seen> window_;  // the newest one last
  std::size_t settings_ = 1;
  bool by_step_ = false;  // they are told apart by the step, not by the blocks
};

}  // namespace coslam
