// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// `coslam calibrate` on pictures of a chessboard taken with a known camera.
#include <gmock/gmock.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "common/dataset/calibration.h"
#include "common/geometry/rigid3.h"
#include "tests/support/board_film.h"
#include "tests/support/temp_folder.h"
#include "tests/system/program.h"

namespace coslam::calibrate_test {
namespace {

using test::FilmedBoard;
using test::Program;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const CameraModel kCamera{320, 240, 260, 262, 163, 118, DistortionModel::kRadTan, {-0.22, 0.06, 0.001, -0.0005}};

// The camera looks at the middle of the board, moved and turned from there; most_tilt_rad 0: straight on.
Rigid3 view(int i, double most_tilt_rad) {
  const double turn = 0.9 * i;
  const Eigen::Quaterniond board_from_cam(Eigen::AngleAxisd(most_tilt_rad * std::sin(turn), Eigen::Vector3d::UnitX()) *
                                          Eigen::AngleAxisd(most_tilt_rad * std::cos(turn), Eigen::Vector3d::UnitY()) *
                                          Eigen::AngleAxisd(0.1 * i, Eigen::Vector3d::UnitZ()));
  const Eigen::Vector3d middle(0.5 * (FilmedBoard::kColumns - 1) * FilmedBoard::kSquare_m,
                               0.5 * (FilmedBoard::kRows - 1) * FilmedBoard::kSquare_m, 0);
  const Eigen::Vector3d in_cam(0.04 * std::sin(2.0 * i), 0.03 * std::cos(1.7 * i), 0.30 + 0.02 * (i % 4));
  return {board_from_cam, middle - board_from_cam * in_cam};
}

class Calibrate : public ::testing::Test {
 protected:
  void take(int pictures, double most_tilt_rad) const {
    const test::BoardFilm film(kCamera, {});
    for (int i = 0; i < pictures; ++i) {
      const auto still = [&](double) { return view(i, most_tilt_rad); };
      cv::imwrite((temp_ / (std::to_string(100 + i) + ".png")).string(), film.picture(still, 0));
    }
  }
  std::vector<std::string> arguments(const std::string& board = "7x5") const {
    return {"calibrate", "--source", temp_.path().string(), "--board", board, "--square", "0.03", "--out", out_};
  }

  const test::TempFolder temp_;
  const std::string out_ = (temp_ / "camera.yaml").string();
};

TEST_F(Calibrate, FindsTheCamera) {
  take(14, 0.5);
  Program calibrate("coslam", arguments());
  ASSERT_EQ(calibrate.exit_code(), 0) << calibrate.err();
  EXPECT_THAT(calibrate.out(), HasSubstr("RMS reprojection error 0."));
  const CameraModel found = load_calibration(out_);
  EXPECT_EQ(found.width_px, kCamera.width_px);
  EXPECT_EQ(found.height_px, kCamera.height_px);
  EXPECT_NEAR(found.fx, kCamera.fx, 0.01 * kCamera.fx) << calibrate.out();
  EXPECT_NEAR(found.fy, kCamera.fy, 0.01 * kCamera.fy);
  for (const Eigen::Vector2d& px : {Eigen::Vector2d(60, 60), Eigen::Vector2d(160, 120), Eigen::Vector2d(260, 190)}) {
    const auto ray = kCamera.normalized_from_pixel(*kCamera.undistorted_from_raw(px));
    const auto found_ray = found.normalized_from_pixel(*found.undistorted_from_raw(px));
    EXPECT_LT((ray - found_ray).norm() * kCamera.fx, 1.5) << px.transpose();
  }
}

TEST_F(Calibrate, RefusesTooFewViews) {
  take(3, 0.5);
  Program calibrate("coslam", arguments());
  EXPECT_EQ(calibrate.exit_code(), 1);
  EXPECT_THAT(calibrate.err(), HasSubstr("coslam: 3 different views of the 7x5 chessboard were found, 8 are needed"));
  EXPECT_FALSE(std::filesystem::exists(out_));
}

TEST_F(Calibrate, RefusesViewsStraightOn) {
  take(12, 0);
  Program calibrate("coslam", arguments());
  EXPECT_EQ(calibrate.exit_code(), 1) << calibrate.out();
  EXPECT_THAT(calibrate.err(), HasSubstr("too alike to tell the focal length"));
}

TEST_F(Calibrate, ABoardThatIsNowhereSeen) {
  take(3, 0.5);
  Program calibrate("coslam", arguments("9x4"));
  EXPECT_EQ(calibrate.exit_code(), 1);
  EXPECT_THAT(calibrate.err(), HasSubstr("--board counts inner corners: a board of 9x7 squares is 8x6"));
}

TEST_F(Calibrate, WrongUsage) {
  for (const char* square : {"30mm", "0", "-1", "30", ""}) {
    std::vector<std::string> words = arguments();
    *(std::ranges::find(words, "--square") + 1) = square;
    Program calibrate("coslam", words);
    EXPECT_EQ(calibrate.exit_code(), 2) << square;
    EXPECT_EQ(calibrate.err(),
              "coslam: --square takes metres, e.g. 0.03 for 30 mm, not '" + std::string(square) + "'\n");
  }
  for (const char* board : {"7", "7x", "7x5x3", "2x5", "axb"}) {
    Program calibrate("coslam", arguments(board));
    EXPECT_EQ(calibrate.exit_code(), 2) << board;
    EXPECT_THAT(calibrate.err(), StartsWith("coslam: --board takes the inner corners as COLSxROWS"));
  }
  Program nothing("coslam", arguments());
  EXPECT_EQ(nothing.exit_code(), 1);
  EXPECT_THAT(nothing.err(), HasSubstr("there is no image in the folder"));
}

}  // namespace
}  // namespace coslam::calibrate_test
