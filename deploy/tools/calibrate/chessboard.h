// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/geometry/camera_model.h"

namespace coslam {

struct Chessboard {
  int columns = 0, rows = 0;  // inner corners
  double square_m = 0;
};

struct CalibrationFit {
  CameraModel camera;  // radtan, 4 coefficients
  double rms_px = 0;   // reprojection error
};

// Views of a chessboard, and the camera that explains them.
class ChessboardViews {
 public:
  static constexpr int kFewest = 8, kMost = 50;

  explicit ChessboardViews(const Chessboard& board) : board_(board) {}

  // Keeps the view when the whole board is seen, elsewhere than in the views before. All images have one size.
  void add(const cv::Mat& grey);
  int count() const { return static_cast<int>(views_.size()); }

  // Throws UserError: too few views, or views that leave the focal length open.
  CalibrationFit fit() const;

 private:
  using Corners = std::vector<cv::Point2f>;

  bool differs(const Corners& corners) const;

  Chessboard board_;
  cv::Size size_;
  std::vector<Corners> views_;
};

}  // namespace coslam
