// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "deploy/coslam/calibrate/dialects.h"

namespace coslam::nearest_camera_test {
namespace {

const CameraModel kFisheye{640, 480, 280, 282, 322, 237, DistortionModel::kEquidistant, {0.01, -0.002, 0, 0}};
const CameraModel kBarrel{752, 480, 458, 457, 367, 248, DistortionModel::kRadTan, {-0.28, 0.07, 0.0002, 0.0001}};
const CameraModel kPinhole{640, 480, 500, 510, 312, 250, DistortionModel::kNone, {}};

// The largest distance, in the image of the first, of where the two see a thing.
double apart_px(const CameraModel& first, const CameraModel& other) {
  double most = 0;
  for (int i = 0; i <= 40; ++i) {
    for (int k = 0; k <= 30; ++k) {
      const double x = i * (first.width_px - 1) / 40.0, y = k * (first.height_px - 1) / 30.0;
      const auto undistorted = first.undistorted_from_raw({x, y});
      if (!undistorted) continue;
      const Eigen::Vector2d n = first.normalized_from_pixel(*undistorted);
      most = std::max(most, (other.pixel_from_normalized(other.distort_normalized(n)) - Eigen::Vector2d(x, y)).norm());
    }
  }
  return most;
}

TEST(NearestCameraOf, APinholeIsItself) {
  const NearestCamera found = nearest_camera(kPinhole, DistortionModel::kRadTan, 0);
  EXPECT_EQ(found.camera.distortion, DistortionModel::kNone);
  EXPECT_LT(found.miss_px, 1e-9);
  EXPECT_EQ(found.camera.fx, kPinhole.fx);
  const NearestCamera bent = nearest_camera(kPinhole, DistortionModel::kRadTan, 5);
  EXPECT_LT(bent.miss_px, 1e-6);
  EXPECT_LT(std::abs(bent.camera.coefficients[0]), 1e-8);
}

TEST(NearestCameraOf, AFisheyeByItsOwnModelHasItsNumbers) {
  const NearestCamera found = nearest_camera(kFisheye, DistortionModel::kEquidistant, 4);
  EXPECT_LT(found.miss_px, 1e-3);
  EXPECT_NEAR(found.camera.fx, kFisheye.fx, 1e-2);
  EXPECT_NEAR(found.camera.cx, kFisheye.cx, 1e-2);
  EXPECT_NEAR(found.camera.coefficients[0], 0.01, 1e-3);
}

TEST(NearestCameraOf, AnotherModelMissesByNoMoreThanIsSaid) {
  const std::pair<const CameraModel*, DistortionModel> pairs[] = {{&kFisheye, DistortionModel::kRadTan},
                                                                  {&kBarrel, DistortionModel::kEquidistant}};
  for (const auto& [lens, model] : pairs) {
    const NearestCamera found = nearest_camera(*lens, model, 4);
    EXPECT_EQ(found.camera.distortion, model);
    EXPECT_GT(found.miss_px, 1e-3) << "it is no lens of that model";
    EXPECT_NEAR(apart_px(*lens, found.camera), found.miss_px, 0.1 * found.miss_px + 0.01);
    EXPECT_LT(found.miss_px, apart_px(*lens,
                                      [&, lens = lens] {
                                        CameraModel straight = *lens;
                                        straight.distortion = DistortionModel::kNone;
                                        return straight;
                                      }()))
        << "nearer than a lens without distortion";
  }
}

TEST(NearestCameraOf, MoreCoefficientsAreNoWorse) {
  double before_px = apart_px(kBarrel, nearest_camera(kBarrel, DistortionModel::kRadTan, 0).camera);
  for (const int count : {1, 2, 4, 5}) {
    const NearestCamera found = nearest_camera(kBarrel, DistortionModel::kRadTan, count);
    EXPECT_LT(found.miss_px, 1.2 * before_px + 1e-6) << count;
    for (std::size_t i = static_cast<std::size_t>(count); i < found.camera.coefficients.size(); ++i) {
      EXPECT_EQ(found.camera.coefficients[i], 0) << "it is not free";
    }
    before_px = found.miss_px;
  }
  EXPECT_LT(before_px, 1e-3);
}

TEST(NearestCameraOf, WhereNoRayHasAPlaceNothingIsNear) {
  CameraModel broken = kPinhole;
  broken.fx = broken.fy = std::nan("");
  EXPECT_TRUE(std::isinf(nearest_camera(broken, DistortionModel::kRadTan, 4).miss_px));
}

}  // namespace
}  // namespace coslam::nearest_camera_test
