// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "common/geometry/camera_model.h"

namespace coslam {

struct Chessboard {
  int columns = 0, rows = 0;  // inner corners
  double square_m = 0;
};

struct CalibrationFit {
  CameraModel camera;    // radtan, 4 coefficients
  double rms_px = 0;     // reprojection error
  int views = 0;         // number of views used
  double readout_s = 0;  // rolling shutter: time from the first row to the last; negative: the last row is first
};

// Views of a chessboard, and the camera that explains them. The camera or the board may move: where the next image
// tells how the corners moved, the readout of a rolling shutter is found together with the camera. A corner in row v is
// then seen v / height of the readout after the first row.
class ChessboardViews {
 public:
  static constexpr int kFewest = 8, kMost = 50;

  explicit ChessboardViews(const Chessboard& board) : board_(board) {}

  // Adds an image; true when it keeps the view: the whole board is seen, elsewhere than in the views before. All images
  // have one size.
  bool add(const cv::Mat& grey);
  // The image after that of the newest view, so much later.
  void add_next(const cv::Mat& grey, double after_s);
  int count() const { return static_cast<int>(views_.size()); }

  // Fits the camera to the kMost views that differ most. Throws UserError: too few views, or views that leave the focal
  // length open.
  CalibrationFit fit() const;

 private:
  using Corners = std::vector<cv::Point2f>;
  struct View {
    Corners corners_px;
    Corners velocity_px_per_s;  // empty: not known
  };

  double distance_px(const View& a, const View& b) const;
  std::vector<View> most_different() const;

  Chessboard board_;
  cv::Size size_;
  std::vector<View> views_;
  cv::Mat newest_;  // the image of the newest view
};

}  // namespace coslam
