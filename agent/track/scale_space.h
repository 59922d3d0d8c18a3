// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

// Scale-invariant blobs: extrema of differences of Gaussians over place and scale (D. Lowe, Distinctive Image Features
// from Scale-Invariant Keypoints, 2004, sections 3 and 4). Greys are integers of 16 bits, kGreyUnit of them a grey
// level, 0 in the middle.
namespace coslam {

constexpr int kScalesPerOctave = 3;
constexpr int kGreyUnit = 128;

// An image at one size, ever more blurred: the level s has a blur of 1.6 * 2^(s / 3) of its pixels.
struct Octave {
  std::array<cv::Mat1s, kScalesPerOctave + 3> levels;
};

// The first octave is of the image at twice its size; each further one has half the size of the one before.
struct ScaleSpace {
  std::vector<Octave> octaves;
};

ScaleSpace scale_space(const cv::Mat1b& grey);

struct Blob {
  float x_px = 0, y_px = 0;  // position in the image
  float contrast = 0;        // share of the whole range of greys
  int octave = 0, level = 0;
  float x = 0, y = 0;  // pixels of the octave
  float sigma_px = 0;  // blur at which it is found, pixels of the octave
};

// Finds all blobs with a contrast of `least` and not on an edge, where the mask, if there is one, is set. A blob
// between pixels may be found twice.
std::vector<Blob> find_blobs(const ScaleSpace& space, float least, const cv::Mat1b& mask = {});

}  // namespace coslam
