// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <opencv2/core/mat.hpp>

namespace coslam {

// A camera that takes its images in turn at several settings: exposures bracketed, a projector of dots that is on in
// some, left and right of a pair as one stream. An image is then far more like the one so many before it than like the
// one before, which motion never does. Images of one setting, and of those that are like it, are used:
// without dots, or else that with the most contrast and, where others have about the same, the darkest of these. Pure;
// for one thread.
class Alternation {
 public:
  // Takes in the next image: the means of its blocks, and by how much neighbouring pixels differ, since projected dots
  // change little else. True: the image is of a setting that is not used.
  bool leaves_out(const cv::Mat& blocks, double step);

 private:
  static constexpr std::size_t kMostSettings = 6, kMostBack = 2 * kMostSettings - 1, kWindow = 4 * kMostSettings;
  // Feature that tells the settings apart.
  enum class By : std::uint8_t { kBlocks, kStep, kExposure };
  using Changes = std::array<double, kMostBack>;  // against the 1, 2, ... before
  struct Seen {
    cv::Mat blocks;
    double step = 0, mean = 0, contrast = 0;  // grey values
    std::size_t backs = 0;                    // number of images before it, kMostBack at most
    Changes of_blocks{}, of_step{}, of_exposure{};
    bool used = true;
    const Changes& changes(By feature) const;
  };
  void note_settings();
  bool none_used_of_late() const;
  void look_anew();
  std::size_t settings_by(By feature, std::size_t most_settings, double least_change) const;
  double mean_change(By feature, std::size_t back, std::size_t first, std::size_t every = 1) const;
  void choose(std::size_t settings);

  std::deque<Seen> window_;  // the newest one last
  std::size_t settings_ = 1;
  By feature_ = By::kBlocks;
};

}  // namespace coslam
