// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/solve/lens.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/matchers.h"

namespace coslam {
namespace {

using test::VectorNear;

const CameraModel kCamera{.width_px = 640, .height_px = 480, .fx = 460, .fy = 458, .cx = 322, .cy = 238};

TEST(LensTest, UndoneIsWhereTheCalibrationAloneHasIt) {
  const LensChange lens{{std::log(0.96), 5, -4, 0.05, -0.03}};
  for (const double x : {-0.7, -0.2, 0.0, 0.4, 0.7}) {
    for (const double y : {-0.5, 0.1, 0.5}) {
      const Eigen::Vector3d in_cam(2 * x, 2 * y, 2);
      EXPECT_THAT(lens.undone(kCamera, lens.project(kCamera, in_cam)), VectorNear(kCamera.project(in_cam), 1e-3));
    }
  }
}

TEST(LensTest, NoChangeIsTheCalibrationToTheBit) {
  const Eigen::Vector3d in_cam(0.3, -0.2, 1.5);
  EXPECT_EQ(LensChange().project(kCamera, in_cam), kCamera.project(in_cam));
  EXPECT_EQ(LensChange().undone(kCamera, {123.4, 56.7}), Eigen::Vector2d(123.4, 56.7));
}

}  // namespace
}  // namespace coslam
