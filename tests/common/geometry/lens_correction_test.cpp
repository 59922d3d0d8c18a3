// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/lens_correction.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/matchers.h"

namespace coslam::lens_correction_test {
namespace {

using test::VectorNear;

LensCorrection correction() {
  LensCorrection lens;
  lens.values << std::log(0.96), 5, -4, 0.004, 0.001, -0.0015, 0.02, -0.01, 0.004, 0.002, -0.001, 0.0005;
  return lens;
}

CameraModel camera_with(DistortionModel distortion) {
  return {.width_px = 640,
          .height_px = 480,
          .fx = 460,
          .fy = 458,
          .cx = 322,
          .cy = 238,
          .distortion = distortion,
          .coefficients = lens_traits(distortion).typical};
}

class LensCorrectionTest : public testing::TestWithParam<DistortionModel> {
 protected:
  const CameraModel camera_ = camera_with(GetParam());
};

TEST_P(LensCorrectionTest, ThereAndBack) {
  const LensCorrection lens = correction();
  for (const double x : {-0.6, -0.2, 0.0, 0.4, 0.6}) {
    for (const double y : {-0.45, 0.1, 0.45}) {
      const Eigen::Vector2d n(x, y);
      const Eigen::Vector2d raw_px = lens.raw_from_normalized(camera_, n);
      const auto back = lens.normalized_from_raw(camera_, raw_px);
      ASSERT_TRUE(back.has_value());
      EXPECT_THAT(*back, VectorNear(n, 2e-7));
      const Eigen::Vector2d px = camera_.pixel_from_normalized(n);
      EXPECT_THAT(lens.raw_from_undistorted(camera_, px), VectorNear(raw_px, 1e-9));
      const auto calibrated_px = lens.calibrated_from_undistorted(camera_, px);
      ASSERT_TRUE(calibrated_px.has_value());
      EXPECT_THAT(camera_.raw_from_undistorted(*calibrated_px), VectorNear(raw_px, 1e-5));
      const auto undistorted_px = lens.undistorted_from_calibrated(camera_, *calibrated_px);
      ASSERT_TRUE(undistorted_px.has_value());
      EXPECT_THAT(*undistorted_px, VectorNear(px, 2e-4));
    }
  }
}

TEST_P(LensCorrectionTest, NoneIsTheCalibration) {
  const Eigen::Vector2d px(123.4, 156.7);
  EXPECT_TRUE(LensCorrection().none());
  EXPECT_EQ(LensCorrection().raw_from_undistorted(camera_, px), camera_.raw_from_undistorted(px));
  EXPECT_EQ(LensCorrection().undistorted_from_calibrated(camera_, px), px);
  EXPECT_EQ(LensCorrection().calibrated_from_undistorted(camera_, px), px);
}

TEST_P(LensCorrectionTest, JacobiansNumerically) {
  constexpr double h = 1e-6;
  const LensCorrection lens = correction();
  for (const Eigen::Vector2d& n : {Eigen::Vector2d(0.5, -0.3), Eigen::Vector2d(-0.1, 0.4), Eigen::Vector2d(0.01, 0)}) {
    LensCorrection::Jacobians j;
    lens.raw_from_normalized(camera_, n, &j);
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector2d d = h * Eigen::Vector2d::Unit(i);
      EXPECT_THAT(
          j.by_normalized.col(i),
          VectorNear((lens.raw_from_normalized(camera_, n + d) - lens.raw_from_normalized(camera_, n - d)) / (2 * h),
                     1e-3));
    }
    for (int i = 0; i < LensCorrection::kTerms; ++i) {
      const LensCorrection::Values d = h * LensCorrection::Values::Unit(i);
      const LensCorrection above{lens.values + d}, below{lens.values - d};
      EXPECT_THAT(
          j.by_values.col(i),
          VectorNear((above.raw_from_normalized(camera_, n) - below.raw_from_normalized(camera_, n)) / (2 * h), 1e-3))
          << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Lenses, LensCorrectionTest, testing::ValuesIn(kDistortionModels));

TEST(LensCorrectionTest, OneThatFoldsTheImageIsNotInvertible) {
  const CameraModel camera = camera_with(DistortionModel::kNone);
  EXPECT_TRUE(is_invertible(camera, correction()));
  LensCorrection folds;
  folds.values[6] = -0.6;
  EXPECT_FALSE(is_invertible(camera, folds));
}

}  // namespace
}  // namespace coslam::lens_correction_test
