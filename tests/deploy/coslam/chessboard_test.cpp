// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/calibrate/chessboard.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "tests/support/board_film.h"

namespace coslam::chessboard_test {
namespace {

using test::BoardFilm;
using test::FilmedBoard;

const CameraModel kCamera{320, 240, 260, 262, 163, 118, DistortionModel::kRadTan, {0.08, -0.12, 0.001, -0.0005}};
constexpr double kPeriod_s = 1 / 30.0;

// A phone in a hand before the board: tilted to all sides, never still.
Rigid3 in_a_hand(double t_s) {
  const auto swing = [t_s](double amplitude, double rate_hz, double phase) {
    return amplitude * std::sin(2 * std::numbers::pi * rate_hz * t_s + phase);
  };
  const Eigen::Quaterniond board_from_cam(
      Eigen::AngleAxisd(swing(0.5, 0.62, 0) + swing(0.006, 7, 1), Eigen::Vector3d::UnitX()) *
      Eigen::AngleAxisd(swing(0.5, 0.86, 2) + swing(0.006, 8, 3), Eigen::Vector3d::UnitY()) *
      Eigen::AngleAxisd(swing(0.3, 0.34, 1), Eigen::Vector3d::UnitZ()));
  const Eigen::Vector3d middle(0.5 * (FilmedBoard::kColumns - 1) * FilmedBoard::kSquare_m,
                               0.5 * (FilmedBoard::kRows - 1) * FilmedBoard::kSquare_m, 0);
  const Eigen::Vector3d in_cam(swing(0.05, 0.74, 0), swing(0.04, 0.58, 1), 0.32 + swing(0.07, 0.46, 2));
  return {board_from_cam, middle - board_from_cam * in_cam};
}

// How far rays are off, at the worst.
double off_px(const CameraModel& found) {
  double most = 0;
  for (double x = 20; x < 320; x += 40) {
    for (double y = 20; y < 240; y += 40) {
      const auto ray = kCamera.normalized_from_pixel(*kCamera.undistorted_from_raw({x, y}));
      const auto found_ray = found.normalized_from_pixel(*found.undistorted_from_raw({x, y}));
      most = std::max(most, (ray - found_ray).norm() * kCamera.fx);
    }
  }
  return most;
}

// next: with the images that tell how the corners move.
CalibrationFit filmed(const BoardFilm::Shutter& shutter, bool next) {
  const BoardFilm film(kCamera, shutter);
  ChessboardViews views({FilmedBoard::kColumns, FilmedBoard::kRows, FilmedBoard::kSquare_m});
  for (double t_s = 0; views.count() < 30; t_s += 0.2) {
    if (views.add(film.picture(in_a_hand, t_s)) && next) {
      views.add_next(film.picture(in_a_hand, t_s + kPeriod_s), kPeriod_s);
    }
  }
  return views.fit();
}

TEST(ChessboardViews, AGlobalShutterHasNoReadout) {
  const CalibrationFit fit = filmed({}, true);
  EXPECT_EQ(fit.readout_s, 0);
  EXPECT_LT(off_px(fit.camera), 1.5);
}

TEST(ChessboardViews, ThePhoneMayMove) {
  const BoardFilm::Shutter shutter{.readout_s = 0.025, .exposure_s = 0.008, .instants = 3};
  const CalibrationFit fit = filmed(shutter, true);
  EXPECT_NEAR(fit.readout_s, shutter.readout_s, 0.003);
  EXPECT_LT(off_px(fit.camera), 2);
  EXPECT_GT(off_px(filmed(shutter, false).camera), 2 * off_px(fit.camera)) << "the motion tells";
}

TEST(ChessboardViews, APhoneHeldUpsideDownIsReadFromBelow) {
  EXPECT_NEAR(filmed({.readout_s = -0.015}, true).readout_s, -0.015, 0.003);
}

}  // namespace
}  // namespace coslam::chessboard_test
