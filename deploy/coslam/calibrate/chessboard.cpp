// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/calibrate/chessboard.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/video/tracking.hpp>
#include <string>
#include <utility>

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

// Solves the camera again and again, for one readout after the other.
class Solver {
 public:
  using Corners = std::vector<cv::Point2f>;
  struct Solution {
    double rms_px = 0, readout_s = 0;
    cv::Mat k, distortion;
    std::vector<cv::Mat> rotations;
    std::vector<double> view_rms_px;
  };

  Solver(const Chessboard& board, cv::Size size) : size_(size) {
    for (int row = 0; row < board.rows; ++row) {
      for (int column = 0; column < board.columns; ++column) {
        on_board_.emplace_back(static_cast<float>(column * board.square_m), static_cast<float>(row * board.square_m),
                               0.0F);
      }
    }
  }

  void add(Corners corners_px, Corners velocity_px_per_s) {
    corners_.push_back(std::move(corners_px));
    velocities_.push_back(std::move(velocity_px_per_s));
  }
  std::size_t views() const { return corners_.size(); }
  bool moves() const {
    const auto known = std::ranges::count_if(velocities_, [](const Corners& v) { return !v.empty(); });
    return 2 * static_cast<std::size_t>(known) > velocities_.size();
  }

  Solution solve(double readout_s) const {
    std::vector<Corners> corners = corners_;
    for (std::size_t view = 0; view < corners.size(); ++view) {
      for (std::size_t i = 0; i < velocities_[view].size(); ++i) {
        cv::Point2f& px = corners[view][i];
        const double after_s = readout_s * (px.y / size_.height - 0.5);
        px -= static_cast<float>(after_s) * velocities_[view][i];
      }
    }
    Solution out;
    out.readout_s = readout_s;
    const std::vector<std::vector<cv::Point3f>> boards(corners.size(), on_board_);
    std::vector<cv::Mat> translations;
    cv::Mat of_camera, of_views, per_view;
    // A third radial coefficient follows the noise of a few views where they do not reach the corners of the picture.
    out.rms_px = cv::calibrateCamera(boards, corners, size_, out.k, out.distortion, out.rotations, translations,
                                     of_camera, of_views, per_view, cv::CALIB_FIX_K3);
    out.view_rms_px.assign(per_view.begin<double>(), per_view.end<double>());
    return out;
  }

  // The sum of squares is nearly a parabola of the readout.
  Solution solve_with_readout() const {
    constexpr double kStep_s = 0.02, kMost_s = 0.06, kLeast_s = 0.002, kTells = 0.97;
    const Solution none = solve(0);
    if (!moves()) return none;
    const auto square = [](const Solution& s) { return s.rms_px * s.rms_px; };
    const double down = square(solve(-kStep_s)), at = square(none), up = square(solve(kStep_s));
    const double curvature = up - 2 * at + down;
    if (curvature <= 0) return none;
    const double readout_s = std::clamp(0.5 * kStep_s * (down - up) / curvature, -kMost_s, kMost_s);
    if (std::abs(readout_s) < kLeast_s) return none;
    Solution with_readout = solve(readout_s);
    return square(with_readout) < kTells * at ? with_readout : none;
  }

  // Views that are far worse than most: blurred ones, or of a board that was bent. False: there are none, or too few
  // would be left.
  bool drop_bad(const Solution& solution) {
    constexpr double kFarWorse = 2.5;
    std::vector<double> sorted = solution.view_rms_px;
    std::ranges::nth_element(sorted, sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2));
    const double most_px = kFarWorse * sorted[sorted.size() / 2];
    const auto good = std::ranges::count_if(solution.view_rms_px, [&](double rms) { return rms <= most_px; });
    if (good == std::ssize(solution.view_rms_px) || good < ChessboardViews::kFewest) return false;
    for (std::size_t i = solution.view_rms_px.size(); i-- > 0;) {
      if (solution.view_rms_px[i] <= most_px) continue;
      corners_.erase(corners_.begin() + static_cast<std::ptrdiff_t>(i));
      velocities_.erase(velocities_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    return true;
  }

 private:
  cv::Size size_;
  std::vector<cv::Point3f> on_board_;
  std::vector<Corners> corners_, velocities_;
};

}  // namespace

bool ChessboardViews::add(const cv::Mat& grey) {
  size_ = grey.size();
  View view;
  const int flags = cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_ACCURACY;
  if (!cv::findChessboardCornersSB(grey, {board_.columns, board_.rows}, view.corners_px, flags)) return false;
  const double least_px = kMoved * size_.width;
  if (std::ranges::any_of(views_, [&](const View& v) { return distance_px(v, view) < least_px; })) return false;
  views_.push_back(std::move(view));
  newest_ = grey;
  return true;
}

void ChessboardViews::add_next(const cv::Mat& grey, double after_s) {
  constexpr double kLongest_s = 0.12;  // later, a hand moves otherwise
  if (newest_.empty() || grey.size() != size_ || after_s <= 0 || after_s > kLongest_s) return;
  View& view = views_.back();
  Corners next;
  std::vector<std::uint8_t> found;
  std::vector<float> errors;
  const int window_px = std::max(11, size_.width / 40);
  cv::calcOpticalFlowPyrLK(newest_, grey, view.corners_px, next, found, errors, {window_px, window_px}, 4);
  newest_.release();
  if (std::ranges::count(found, 0) > 0) return;
  for (std::size_t i = 0; i < next.size(); ++i) {
    view.velocity_px_per_s.push_back((next[i] - view.corners_px[i]) * (1 / static_cast<float>(after_s)));
  }
}

double ChessboardViews::distance_px(const View& a, const View& b) const {
  double sum_px = 0;
  for (std::size_t i = 0; i < a.corners_px.size(); ++i) sum_px += cv::norm(a.corners_px[i] - b.corners_px[i]);
  return sum_px / static_cast<double>(a.corners_px.size());
}

// Each is the farthest from those before.
std::vector<ChessboardViews::View> ChessboardViews::most_different() const {
  if (count() <= kMost) return views_;
  std::vector<double> far_px(views_.size(), std::numeric_limits<double>::max());
  std::vector<View> chosen;
  for (std::size_t next = 0; chosen.size() < kMost;
       next = static_cast<std::size_t>(std::ranges::max_element(far_px) - far_px.begin())) {
    chosen.push_back(views_[next]);
    for (std::size_t i = 0; i < views_.size(); ++i)
      far_px[i] = std::min(far_px[i], distance_px(views_[i], views_[next]));
  }
  return chosen;
}

CalibrationFit ChessboardViews::fit() const {
  const std::string board = std::to_string(board_.columns) + "x" + std::to_string(board_.rows) + " chessboard";
  if (count() < kFewest) {
    throw UserError(std::to_string(count()) + " different views of the " + board + " were found, " +
                    std::to_string(kFewest) + " are needed" + kAdvice +
                    (count() == 0 ? "; --board counts inner corners: a board of 9x7 squares is 8x6" : ""));
  }
  Solver solver(board_, size_);
  for (View& view : most_different()) solver.add(std::move(view.corners_px), std::move(view.velocity_px_per_s));
  Solver::Solution solution = solver.solve_with_readout();
  if (solver.drop_bad(solution)) solution = solver.solve_with_readout();
  const cv::Mat &k = solution.k, &d = solution.distortion;
  CalibrationFit fit;
  fit.rms_px = solution.rms_px;
  fit.views = static_cast<int>(solver.views());
  fit.readout_s = solution.readout_s;
  fit.camera = {size_.width,
                size_.height,
                k.at<double>(0, 0),
                k.at<double>(1, 1),
                k.at<double>(0, 2),
                k.at<double>(1, 2),
                DistortionModel::kRadTan,
                {d.at<double>(0), d.at<double>(1), d.at<double>(2), d.at<double>(3)}};
  if (problem_of(fit.camera) || largest_tilt(solution.rotations) < kLeastTilt_rad) {
    throw UserError("the views of the " + board + " are too alike to tell the focal length" + kAdvice);
  }
  return fit;
}

}  // namespace coslam
