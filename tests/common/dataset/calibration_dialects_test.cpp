// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "common/base/error.h"
#include "common/dataset/calibration.h"
#include "tests/common/dataset/calibration_files.h"
#include "tests/support/temp_folder.h"

namespace coslam::calibration_dialects_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// What files of these forms have seldom, and what is wrong about them.
class CalibrationDialects : public test::CalibrationFiles {};

const std::string kPlain = "width: 752\nheight: 480\nfx: 458\nfy: 457\ncx: 367\ncy: 248\n";
const std::string kMatrix = "camera_matrix: [458, 0, 367, 0, 457, 248, 0, 0, 1]\n";

std::string of_kalibr(const std::string& model, const std::string& intrinsics, const std::string& more) {
  return "cam0:\n  camera_model: " + model + "\n  intrinsics: [" + intrinsics + "]\n  resolution: [752, 480]\n" + more;
}

TEST_F(CalibrationDialects, NumbersThatAreNoneAreToldWithTheirLine) {
  EXPECT_THAT(error("width: wide\nheight: 480\nfx: 458\nfy: 457\ncx: 367\ncy: 248\n"),
              HasSubstr("calib.yaml:1: width"));
  EXPECT_THAT(error("width: 752\nheight: 480\nfx: [1]\nfy: 457\ncx: 367\ncy: 248\n"), HasSubstr("calib.yaml:3: fx"));
  EXPECT_THAT(error(kPlain + "distortion_model: radtan\ndistortion: [0.1, x, 0, 0]\n"), HasSubstr("calib.yaml:8"));
  EXPECT_NE(error("width: 99999999999\nheight: -480\nfx: 458\nfy: 457\ncx: 367\ncy: 248\n"), "");
  EXPECT_NE(error("width: 752\nheight: 480\nfx: .nan\nfy: 457\ncx: 367\ncy: 248\n"), "");
}

TEST_F(CalibrationDialects, ALensHasAsManyCoefficientsAsItsModel) {
  const auto lens = [](const std::string& model, const std::string& k) {
    return kPlain + "distortion_model: " + model + "\ndistortion: [" + k + "]\n";
  };
  EXPECT_THAT(error(lens("none", "0.1")), HasSubstr("the distortion model 'none' has no coefficients"));
  EXPECT_THAT(error(lens("unknown", "0.1")), HasSubstr("'unknown' has no coefficients"));
  EXPECT_EQ(load(lens("unknown", "0, 0")).distortion, DistortionModel::kUnknown);
  EXPECT_THAT(error(lens("equidistant", "0.1, 0, 0")), HasSubstr("4 equidistant coefficients (k1 k2 k3 k4)"));
  EXPECT_THAT(error(lens("double_sphere", "0.1")), HasSubstr("2 double_sphere coefficients (xi alpha)"));
  EXPECT_THAT(error(lens("omni", "0.9, 0, 0, 0")), HasSubstr("5 omni coefficients (xi k1 k2 p1 p2)"));
  EXPECT_THAT(error(lens("radtan", "0.1, 0, 0, 0, 0, 0")), HasSubstr("6 radtan coefficients, 4, 5 or 8 are expected"));
  EXPECT_THAT(error(lens("double_sphere", "-1.5, 0.6")), HasSubstr("xi of the lens must be above -1"));
  EXPECT_EQ(load(lens("radtan", "0, 0, 0, 0, 0, 0")).distortion, DistortionModel::kNone);
}

TEST_F(CalibrationDialects, ThereAreManyWordsForNoFisheye) {
  const auto lens = [&](const std::string& word) {
    return load("image_width: 752\nimage_height: 480\n" + kMatrix +
                "distortion_coefficients: [0.01, 0.002, 0, 0]\nfisheye_model: " + word + "\n")
        .distortion;
  };
  for (const char* no : {"0", "false", "False", "no", "OFF"}) EXPECT_EQ(lens(no), DistortionModel::kRadTan) << no;
  for (const char* yes : {"1", "true", "yes"}) EXPECT_EQ(lens(yes), DistortionModel::kEquidistant) << yes;
}

TEST_F(CalibrationDialects, FocalLengthsOfSpheresAreThoseOfTheMiddle) {
  const CameraModel c = load(kPlain + "distortion_model: mei\ndistortion: [1, 0.01, 0, 0, 0]\n");
  EXPECT_EQ(c.distortion, DistortionModel::kOmni);
  EXPECT_DOUBLE_EQ(c.fx, 229);
  EXPECT_DOUBLE_EQ(c.fy, 228.5);
}

TEST_F(CalibrationDialects, AMatrixIsAListOrRowsOrData) {
  const std::string size = "image_size: [752, 480]\ndistortion: [0.1, 0, 0, 0]\n";
  for (const std::string& matrix :
       {kMatrix, std::string("camera_matrix: [[458, 0, 367], [0, 457, 248], [0, 0, 1]]\n"),
        std::string("camera_matrix: {rows: 3, cols: 3, data: [458, 0, 367, 0, 457, 248, 0, 0, 1]}\n")}) {
    const CameraModel c = load(size + matrix);
    EXPECT_EQ(c.width_px, 752);
    EXPECT_EQ(c.fy, 457);
    EXPECT_EQ(c.cx, 367);
  }
  EXPECT_THAT(error(size + "camera_matrix: [458, 0, 367, 0, 457, 248]\n"), HasSubstr("nine elements"));
  EXPECT_THAT(error(size + "camera_matrix: []\n"), HasSubstr("nine elements"));
  EXPECT_THAT(error(size + "camera_matrix: {rows: 3, cols: 3}\n"), HasSubstr("'data' is missing"));
  EXPECT_THAT(error(size + "camera_matrix: [458, 2, 367, 0, 457, 248, 0, 0, 1]\n"), HasSubstr("skew"));
  EXPECT_THAT(error(size + "camera_matrix: [458, 0, 0, 0, 457, 0, 367, 248, 1]\n"), HasSubstr("rows and columns"));
  EXPECT_THAT(error("image_size: [752]\ndistortion: [0.1, 0, 0, 0]\n" + kMatrix), HasSubstr("[width, height]"));
  EXPECT_THAT(error("distortion: [0.1, 0, 0, 0]\n" + kMatrix), HasSubstr("'image_width' is missing"));
}

TEST_F(CalibrationDialects, TermsOfAThinPrismAreLeftOut) {
  const std::string head = "image_width: 752\nimage_height: 480\n" + kMatrix;
  const CameraModel c = load(head + "dist: [0.1, 0.02, 0, 0, 0, 0.3, 0, 0, 0.001, 0, -0.002]\n");
  EXPECT_THAT(c.coefficients, ElementsAre(0.1, 0.02, 0, 0, 0, 0.3, 0, 0));
  EXPECT_EQ(load(head + "dist: [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]\n").distortion, DistortionModel::kNone);
  EXPECT_THAT(error(head + "dist: [0.1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.01]\n"), HasSubstr("tilted sensor"));
}

TEST_F(CalibrationDialects, OrbSlamHasLensesWithAndWithoutNames) {
  const std::string head =
      "Camera.fx: 458\nCamera.fy: 457\nCamera.cx: 367\nCamera.cy: 248\nCamera.cols: 752\n"
      "Camera.rows: 480\n";
  EXPECT_EQ(load(head).distortion, DistortionModel::kNone);
  EXPECT_EQ(load("Camera.type: \"Rectified\"\n" + head + "Camera.k1: 0.3\n").distortion, DistortionModel::kNone);
  const CameraModel radial = load("Camera.type: \"PinHole\"\n" + head + "Camera.k1: 0.3\nCamera.k3: 0.05\n");
  EXPECT_THAT(radial.coefficients, ElementsAre(0.3, 0, 0, 0, 0.05, 0, 0, 0));
  EXPECT_THAT(error("Camera.type: \"fisheye\"\n" + head + "Camera.k1: 0.3\nCamera.p2: 0.1\n"),
              HasSubstr("Camera.p2: is no term of the lens 'fisheye'"));
  EXPECT_THAT(error("Camera.type: \"equirectangular\"\n" + head), HasSubstr("'equirectangular' is not supported"));
}

TEST_F(CalibrationDialects, ImagesOfARosCameraMayBeAPartAndBinned) {
  const std::string head =
      "width: 752\nheight: 480\ndistortion_model: plumb_bob\nd: [0.1, 0, 0, 0, 0]\n"
      "k: [458, 0, 367, 0, 457, 248, 0, 0, 1]\n";
  const CameraModel part = load(head + "roi: {x_offset: 100, y_offset: 40, width: 500, height: 400}\n");
  EXPECT_EQ(part.width_px, 500);
  EXPECT_EQ(part.cx, 267);
  EXPECT_EQ(part.cy, 208);
  EXPECT_EQ(part.fx, 458);
  const CameraModel binned = load(head + "binning_x: 2\nbinning_y: 2\n");
  EXPECT_EQ(binned.width_px, 376);
  EXPECT_EQ(binned.fx, 229);
  EXPECT_EQ(binned.cx, 183.25) << "the centre of a pixel is that of the four it is made of";
  EXPECT_EQ(load(head + "roi: {x_offset: 0, y_offset: 0, width: 0, height: 0}\nbinning_x: 0\n").width_px, 752)
      << "zeros mean the whole";
  EXPECT_EQ(load(head + "binning_x: -3\nroi: none\n").fx, 458);
}

TEST_F(CalibrationDialects, ARosCameraWithoutDistortionHasNoModel) {
  const std::string head = "width: 752\nheight: 480\nk: [458, 0, 367, 0, 457, 248, 0, 0, 1]\n";
  EXPECT_EQ(load(head + "distortion_model: \"\"\nd: []\n").distortion, DistortionModel::kNone);
  EXPECT_THAT(error(head + "distortion_model: plumb_bob\n"), HasSubstr("'distortion_coefficients' is missing"));
}

TEST_F(CalibrationDialects, KalibrsModelsSayWhatTheirNumbersAre) {
  const std::string radtan = "  distortion_model: radtan\n  distortion_coeffs: [0.1, 0, 0, 0]\n";
  EXPECT_THAT(error(of_kalibr("pinhole", "458, 457, 367", radtan)), HasSubstr("[fx, fy, cx, cy] is expected"));
  EXPECT_THAT(error(of_kalibr("omni", "458, 457, 367, 248", radtan)), HasSubstr("[xi, fx, fy, cx, cy] is expected"));
  EXPECT_THAT(error(of_kalibr("omni", "0.9, 458, 457, 367, 248", "  distortion_model: equidistant\n")),
              HasSubstr("'equidistant' is not supported with the camera model 'omni'"));
  EXPECT_THAT(error(of_kalibr("pinhole", "458, 457, 367, 248", "")), HasSubstr("'distortion_model' is missing"));
  EXPECT_THAT(error("cam0: {camera_model: pinhole, intrinsics: [1, 1, 1, 1], resolution: 752}\n"),
              HasSubstr("calib.yaml:1"));
}

// Of it a ray is seen at x / (alpha d + (1 - alpha) z) with d = sqrt(beta x^2 + z^2).
TEST_F(CalibrationDialects, AnExtendedUnifiedLensIsMetByTheNearestFisheye) {
  constexpr double kAlpha = 0.6, kBeta = 1.1;
  const CameraModel c = load(of_kalibr("eucm", "0.6, 1.1, 458, 458, 367, 248", ""));
  for (const double angle : {0.05, 0.3, 0.6}) {
    const double x = std::sin(angle), z = std::cos(angle);
    const double expected_px = 458 * x / (kAlpha * std::sqrt(kBeta * x * x + z * z) + (1 - kAlpha) * z);
    EXPECT_NEAR(c.raw_from_undistorted(c.project({x / z, 0, 1})).x() - c.cx, expected_px, 0.2) << angle;
  }
  EXPECT_THAT(error(of_kalibr("eucm", "1.6, 1.1, 458, 458, 367, 248", "")), HasSubstr("alpha from 0 to 1"));
  EXPECT_THAT(error(of_kalibr("eucm", "0.6, 0, 458, 458, 367, 248", "")), HasSubstr("beta above 0"));
  EXPECT_THAT(error(of_kalibr("eucm", "0.6, .nan, 458, 458, 367, 248", "")), HasSubstr("calib.yaml:3"));
}

TEST_F(CalibrationDialects, OnlyPinholesOfEurocAreRead) {
  const std::string tail =
      "resolution: [752, 480]\nintrinsics: [458, 457, 367]\ndistortion_model: radial-tangential\n"
      "distortion_coefficients: [0.1, 0, 0, 0]\n";
  EXPECT_THAT(error("sensor_type: camera\ncamera_model: omni\n" + tail), HasSubstr("'omni' is not supported"));
  EXPECT_THAT(error("sensor_type: camera\ncamera_model: pinhole\n" + tail), HasSubstr("[fx, fy, cx, cy] is expected"));
  EXPECT_THAT(error("sensor_type: camera\n" + tail), HasSubstr("'camera_model' is missing"));
}

TEST_F(CalibrationDialects, ACameraOfAFileWithOneIsNotNamed) {
  EXPECT_THAT(error(kPlain, "cam0"), HasSubstr("there is one camera in a file: leave out #cam0"));
}

}  // namespace
}  // namespace coslam::calibration_dialects_test
