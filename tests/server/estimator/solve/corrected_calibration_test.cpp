// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/corrected_calibration.h"

#include <gtest/gtest.h>

#include <cmath>

namespace coslam::corrected_calibration_test {
namespace {

LensCorrection correction(double scale = 1) {
  LensCorrection lens;
  lens.values << std::log(0.97), 5, -4, 0.004, 0, 0, 0.006, 0, 0, 0, 0, 0;
  lens.values *= scale;
  return lens;
}

TEST(CorrectedCalibrationTest, APinholeBecomesTheSameLensAsRadtan) {
  const CameraModel pinhole{.width_px = 640, .height_px = 480, .fx = 460, .fy = 458, .cx = 322, .cy = 238};
  const auto [camera, worst_px] = corrected_calibration(pinhole, correction());
  EXPECT_EQ(camera.distortion, DistortionModel::kRadTan);
  EXPECT_LT(worst_px, 0.1);
  EXPECT_NEAR(camera.fx, 460 * 0.97 * std::exp(-0.002), 0.01);
  EXPECT_NEAR(camera.cy, 234, 0.01);
  EXPECT_NEAR(camera.coefficients[0], -2 * 0.006 * 4 * 460 * 458 / (640 * 640 + 480 * 480), 2e-3) << "-2 a / R^2";
}

TEST(CorrectedCalibrationTest, OtherLensesStayOfTheirKind) {
  CameraModel camera{.width_px = 640,
                     .height_px = 480,
                     .fx = 360,
                     .fy = 358,
                     .cx = 322,
                     .cy = 238,
                     .distortion = DistortionModel::kEquidistant,
                     .coefficients = {0.01, -0.005, 0.002, -0.001}};
  EXPECT_LT(corrected_calibration(camera, correction()).worst_px, 0.3);
  camera.distortion = DistortionModel::kRadTan;
  camera.coefficients = {-0.28, 0.07, 0.0002, 0.00002};
  EXPECT_LT(corrected_calibration(camera, correction(0.5)).worst_px, 0.3);
}

TEST(CorrectedCalibrationTest, NothingWrongIsTheCalibrationItself) {
  const CameraModel camera{.width_px = 640, .height_px = 480, .fx = 460, .fy = 458, .cx = 322, .cy = 238};
  EXPECT_EQ(corrected_calibration(camera, {}).camera, camera);
}

}  // namespace
}  // namespace coslam::corrected_calibration_test
