// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/tools/calibrate/chessboard.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <string>

#include "common/base/error.h"

namespace coslam {
namespace {

constexpr double kMoved = 0.03;          // mean displacement of the corners between two views, of the image width
constexpr double kLeastTilt_rad = 0.35;  // between some two views: without, focal length and distance go together

const char* const kAdvice = ": show it tilted to all sides, near and far, and in every part of the picture";

// Largest angle between the board's normals in two views.
double largest_tilt(const std::vector<cv::Mat>& rotations) {
  std::vector<cv::Vec3d> normals;
  for (const cv::Mat& rotation : rotations) {
    cv::Matx33d r;
    cv::Rodrigues(rotation, r);
    normals.emplace_back(r(0, 2), r(1, 2), r(2, 2));
  }
  double least_cos = 1;
  for (const cv::Vec3d& a : normals) {
    for (const cv::Vec3d& b : normals) least_cos = std::min(least_cos, a.dot(b));
  }
  return std::acos(std::max(-1.0, least_cos));
}

}  // namespace

void ChessboardViews::add(const cv::Mat& grey) {
  size_ = grey.size();
  Corners corners;
  const int flags = cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_ACCURACY;
  if (!cv::findChessboardCornersSB(grey, {board_.columns, board_.rows}, corners, flags)) return;
  if (differs(corners)) views_.push_back(std::move(corners));
}

bool ChessboardViews::differs(const Corners& corners) const {
  return std::ranges::none_of(views_, [&](const Corners& view) {
    double sum_px = 0;
    for (std::size_t i = 0; i < view.size(); ++i) sum_px += cv::norm(view[i] - corners[i]);
    return sum_px < kMoved * size_.width * static_cast<double>(view.size());
  });
}

CalibrationFit ChessboardViews::fit() const {
  const std::string board = std::to_string(board_.columns) + "x" + std::to_string(board_.rows) + " chessboard";
  if (count() < kFewest) {
    throw UserError(std::to_string(count()) + " different views of the " + board + " were found, " +
                    std::to_string(kFewest) + " are needed" + kAdvice);
  }
  std::vector<cv::Point3f> on_board;
  for (int row = 0; row < board_.rows; ++row) {
    for (int column = 0; column < board_.columns; ++column) {
      on_board.emplace_back(static_cast<float>(column * board_.square_m), static_cast<float>(row * board_.square_m),
                            0.0F);
    }
  }
  const std::vector<std::vector<cv::Point3f>> boards(views_.size(), on_board);
  cv::Mat k, d;
  std::vector<cv::Mat> rotations, translations;
  CalibrationFit fit;
  // A third radial coefficient follows the noise of a few views where they do not reach the corners of the picture.
  fit.rms_px = cv::calibrateCamera(boards, views_, size_, k, d, rotations, translations, cv::CALIB_FIX_K3);
  fit.camera = {size_.width,
                size_.height,
                k.at<double>(0, 0),
                k.at<double>(1, 1),
                k.at<double>(0, 2),
                k.at<double>(1, 2),
                DistortionModel::kRadTan,
                {d.at<double>(0), d.at<double>(1), d.at<double>(2), d.at<double>(3)}};
  if (problem_of(fit.camera) || largest_tilt(rotations) < kLeastTilt_rad) {
    throw UserError("the views of the " + board + " are too alike to tell the focal length" + kAdvice);
  }
  return fit;
}

}  // namespace coslam
