// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "common/base/error.h"
#include "common/dataset/calibration.h"
#include "tests/support/temp_folder.h"

namespace coslam::calibration_colmap_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class CalibrationOfColmap : public ::testing::Test {
 protected:
  CameraModel load(const std::string& text, const std::string& camera = "") {
    return load_calibration(folder_.write("cameras.txt", text).string() + (camera.empty() ? "" : "#" + camera));
  }
  std::string error(const std::string& text, const std::string& camera = "") {
    return test::error_of<UserError>([&] { load(text, camera); });
  }
  test::TempFolder folder_;
};

TEST_F(CalibrationOfColmap, EveryModelHasItsParametersInItsOrder) {
  const std::string simple = " 752 480 458 367.5 248.5", full = " 752 480 458 457 367.5 248.5";
  for (const std::string& text :
       {"1 SIMPLE_PINHOLE" + simple, "1 PINHOLE" + full, "1 SIMPLE_RADIAL" + simple + " 0.1",
        "1 RADIAL" + simple + " 0.1 0.02", "1 OPENCV" + full + " 0.1 0.02 0.001 0.002",
        "1 FULL_OPENCV" + full + " 0.1 0.02 0.001 0.002 0.03 0.2 0.04 0.05",
        "1 OPENCV_FISHEYE" + full + " 0.1 0.02 0.001 0.002", "1 SIMPLE_RADIAL_FISHEYE" + simple + " 0.1",
        "1 RADIAL_FISHEYE" + simple + " 0.1 0.02"}) {
    const CameraModel c = load(text + "\n");
    EXPECT_EQ(c.width_px, 752) << text;
    EXPECT_EQ(c.height_px, 480) << text;
    EXPECT_EQ(c.fx, 458) << text;
    EXPECT_EQ(c.fy, text.find(full) == std::string::npos ? 458 : 457) << text;
    EXPECT_EQ(c.cx, 367) << text << ": the centre of COLMAP's first pixel is (0.5, 0.5)";
    EXPECT_EQ(c.cy, 248) << text;
    EXPECT_EQ(c.coefficients[0], text.find("PINHOLE") == std::string::npos ? 0.1 : 0) << text;
  }
  EXPECT_THAT(load("1 FULL_OPENCV" + full + " 1 2 3 4 5 6 7 8\n").coefficients, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
  EXPECT_EQ(load("1 RADIAL" + simple + " 0.1 0.02\n").distortion, DistortionModel::kRadTan);
  EXPECT_EQ(load("1 RADIAL_FISHEYE" + simple + " 0.1 0.02\n").distortion, DistortionModel::kEquidistant);
}

TEST_F(CalibrationOfColmap, AThinPrismIsLeftOutOfAFisheye) {
  const CameraModel c =
      load("1 THIN_PRISM_FISHEYE 752 480 458 457 367.5 248.5 0.01 0.002 0.0001 -0.0001 0.003 0.0004 0.0002 0.0001\n");
  EXPECT_EQ(c.distortion, DistortionModel::kEquidistant);
  EXPECT_THAT(c.coefficients, ElementsAre(0.01, 0.002, 0.003, 0.0004, 0, 0, 0, 0));
}

// Of it a ray at this angle is seen at atan(2 tan(angle) tan(w / 2)) / w.
TEST_F(CalibrationOfColmap, AFieldOfViewLensIsMetByTheNearestFisheye) {
  constexpr double kW = 0.9;
  const CameraModel c = load("1 FOV 640 480 400 400 320.5 240.5 0.9\n");
  EXPECT_EQ(c.distortion, DistortionModel::kEquidistant);
  for (const double angle : {0.05, 0.2, 0.4, 0.6}) {
    const double expected_px = 400 * std::atan(2 * std::tan(angle) * std::tan(kW / 2)) / kW;
    const Eigen::Vector2d seen_px = c.raw_from_undistorted(c.project({std::tan(angle), 0, 1}));
    EXPECT_NEAR(seen_px.x() - c.cx, expected_px, 0.2) << angle;
  }
}

TEST_F(CalibrationOfColmap, CommentsAndEmptyLinesAreLeftOut) {
  const CameraModel c = load(
      "# Camera list with one line of data per camera:\n\n#   CAMERA_ID, MODEL\r\n"
      "   3   PINHOLE\t752 480  458 457 367.5 248.5  \r\n\n");
  EXPECT_EQ(c.fy, 457);
}

TEST_F(CalibrationOfColmap, ALineThatIsWrongIsTold) {
  EXPECT_THAT(error("# one\n1 PINHOLE 752\n"), HasSubstr("cameras.txt:2: not a line `ID MODEL WIDTH HEIGHT PARAMS`"));
  EXPECT_THAT(error("1 PINHOLE 752 480 x 457 367 248\n"), HasSubstr("cameras.txt:1: 'x' is not a number"));
  EXPECT_THAT(error("1 PINHOLE 752 480 nan 457 367 248\n"), HasSubstr("'nan' is not a number"));
  for (const char* text : {"1 PINHOLE 752 480 458\n", "1 PINHOLE 752 480 458 457 367 248 0.1\n",
                           "1 SIMPLE_RADIAL 752 480 458 367 248\n", "1 FOV 752 480 458 457 367 248\n"}) {
    EXPECT_THAT(error(text), HasSubstr("the number of parameters does not fit")) << text;
  }
  EXPECT_NE(error("1 PINHOLE 1e30 -5 458 457 367 248\n"), "") << "no image has that size";
  EXPECT_THAT(error("1 SIMPLE_DIVISION 752 480 458 367 248 0.1\n"), HasSubstr("'SIMPLE_DIVISION' is not supported"));
}

TEST_F(CalibrationOfColmap, OfSeveralCamerasOneIsNamed) {
  const std::string text = "1 PINHOLE 640 480 400 400 320 240\n7 PINHOLE 752 480 458 457 367 248\n2 PINHOLE broken\n";
  EXPECT_EQ(load(text.substr(0, text.find("2 PINHOLE")), "7").width_px, 752);
  EXPECT_THAT(error(text, "8"), HasSubstr("cameras.txt:3: not a line"));
  EXPECT_THAT(error("1 PINHOLE 640 480 400 400 320 240\n", "8"), HasSubstr("there is no camera '8' in it"));
  EXPECT_THAT(error("1 PINHOLE 640 480 400 400 320 240\n7 UNKNOWN 640 480 1 2 3 4\n"), HasSubstr("(1, 7): name one"));
}

}  // namespace
}  // namespace coslam::calibration_colmap_test
