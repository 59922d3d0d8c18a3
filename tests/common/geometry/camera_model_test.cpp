// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/camera_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/matchers.h"

namespace coslam::camera_model_test {
namespace {

using test::VectorNear;

CameraModel pinhole() {
  CameraModel c;
  c.width_px = 752;
  c.height_px = 480;
  c.fx = 458.654;
  c.fy = 457.296;
  c.cx = 367.215;
  c.cy = 248.375;
  return c;
}

CameraModel with(DistortionModel model, const std::array<double, 8>& coefficients) {
  CameraModel c = pinhole();
  c.distortion = model;
  c.coefficients = coefficients;
  return c;
}

struct Named {
  std::string name;
  CameraModel camera;
};

class EveryModel : public testing::TestWithParam<Named> {};

TEST_P(EveryModel, UndistortsTheWholeImageAndBack) {
  const CameraModel& c = GetParam().camera;
  for (int y = 0; y < c.height_px; y += 8) {
    for (int x = 0; x < c.width_px; x += 8) {
      const Eigen::Vector2d raw(x, y);
      const auto undistorted = c.undistorted_from_raw(raw);
      ASSERT_TRUE(undistorted) << raw.transpose();
      ASSERT_THAT(c.raw_from_undistorted(*undistorted), VectorNear(raw, 1e-5)) << raw.transpose();
    }
  }
}

TEST_P(EveryModel, DistortionVanishesAtThePrincipalPoint) {
  const CameraModel& c = GetParam().camera;
  const Eigen::Vector2d center(c.cx, c.cy);
  EXPECT_THAT(c.raw_from_undistorted(center), VectorNear(center, 1e-9));
  const Eigen::Vector2d near(c.cx + 0.5, c.cy - 0.5);
  EXPECT_THAT(c.raw_from_undistorted(near), VectorNear(near, 1e-2));
}

TEST_P(EveryModel, RawByUndistortedNumerically) {
  CameraModel c = GetParam().camera;
  c.fy = 0.9 * c.fx;
  constexpr double h = 1e-4;
  for (const Eigen::Vector2d& raw : {Eigen::Vector2d(c.cx, c.cy), Eigen::Vector2d(c.cx + 1, c.cy - 2),
                                     Eigen::Vector2d(20, 30), Eigen::Vector2d(700, 200)}) {
    const Eigen::Vector2d px = *c.undistorted_from_raw(raw);
    const Eigen::Matrix2d j = c.raw_by_undistorted(px);
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector2d d = h * Eigen::Vector2d::Unit(i);
      const Eigen::Vector2d expected = (c.raw_from_undistorted(px + d) - c.raw_from_undistorted(px - d)) / (2 * h);
      EXPECT_THAT(j.col(i), VectorNear(expected, 1e-6)) << raw.transpose();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    CameraModel, EveryModel,
    testing::Values(Named{"none", pinhole()},
                    Named{"euroc",
                          with(DistortionModel::kRadTan, {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05})},
                    Named{"radtan5", with(DistortionModel::kRadTan, {-0.2, 0.05, 1e-3, -2e-3, -0.01})},
                    Named{"rational", with(DistortionModel::kRadTan, {0.5, 0.1, 1e-4, 1e-4, 0.01, 0.8, 0.2, 0.02})},
                    Named{"equidistant", with(DistortionModel::kEquidistant, {-0.01, 0.02, -0.015, 0.004})},
                    Named{"ideal_fisheye", with(DistortionModel::kEquidistant, {})},
                    Named{"double_sphere", with(DistortionModel::kDoubleSphere, {-0.25, 0.6})},
                    Named{"far_spheres", with(DistortionModel::kDoubleSphere, {0.4, 0.3})},
                    Named{"omni", with(DistortionModel::kOmni, {0.9, -0.1, 0.02, 3e-4, -2e-4})}),
    [](const auto& p) { return p.param.name; });

std::vector<Named> typical_lenses() {
  std::vector<Named> out;
  for (const DistortionModel model : kDistortionModels) {
    out.push_back({std::string(lens_traits(model).name()), with(model, lens_traits(model).typical)});
  }
  return out;
}

INSTANTIATE_TEST_SUITE_P(TypicalLens, EveryModel, testing::ValuesIn(typical_lenses()),
                         [](const auto& p) { return p.param.name; });

TEST(CameraModel, RadTanIsTheFormula) {
  const CameraModel c = with(DistortionModel::kRadTan, {-0.3, 0.1, 0.01, -0.02, 0.005});
  const double x = 0.3, y = -0.2, r2 = x * x + y * y, radial = 1 - 0.3 * r2 + 0.1 * r2 * r2 + 0.005 * r2 * r2 * r2;
  const Eigen::Vector2d expected(x * radial + 2 * 0.01 * x * y - 0.02 * (r2 + 2 * x * x),
                                 y * radial + 0.01 * (r2 + 2 * y * y) + 2 * -0.02 * x * y);
  EXPECT_THAT(c.distort_normalized({x, y}), VectorNear(expected, 1e-15));
}

TEST(CameraModel, EquidistantIsTheAngle) {
  const CameraModel c = with(DistortionModel::kEquidistant, {});
  // Without coefficients the distance from the centre is the angle itself.
  EXPECT_THAT(c.distort_normalized({1, 0}), VectorNear(Eigen::Vector2d(std::atan(1.0), 0), 1e-12));
}

TEST(CameraModel, DoubleSphereIsTheFormula) {
  const double xi = -0.2, alpha = 0.6, x = 0.7, y = -1.1, z = 0.8;
  const double d1 = std::sqrt(x * x + y * y + z * z), d2 = std::sqrt(x * x + y * y + (xi * d1 + z) * (xi * d1 + z));
  const double under = alpha * d2 + (1 - alpha) * (xi * d1 + z);
  const CameraModel c = with(DistortionModel::kDoubleSphere, {xi, alpha});
  const Eigen::Vector2d expected = (1 + xi) * Eigen::Vector2d(x, y) / under;  // of the image with focal length 1
  EXPECT_THAT(c.distort_normalized({x / z, y / z}), VectorNear(expected, 1e-12));
}

TEST(CameraModel, OmniIsTheFormula) {
  const double xi = 1.1;
  const Eigen::Vector3d on_sphere = Eigen::Vector3d(0.7, -1.1, 0.8).normalized();
  const Eigen::Vector2d m = on_sphere.head<2>() / (on_sphere.z() + xi);
  const CameraModel radtan = with(DistortionModel::kRadTan, {-0.1, 0.02, 3e-4, -2e-4});
  const CameraModel c = with(DistortionModel::kOmni, {xi, -0.1, 0.02, 3e-4, -2e-4});
  EXPECT_THAT(c.distort_normalized(Eigen::Vector2d(0.7, -1.1) / 0.8),
              VectorNear(((1 + xi) * radtan.distort_normalized(m)).eval(), 1e-12));
}

TEST(CameraModel, SpheresHaveNoRaysBesideAPinhole) {
  for (const CameraModel& c :
       {with(DistortionModel::kDoubleSphere, {-0.25, 0.6}), with(DistortionModel::kOmni, {1.0})}) {
    const double just = c.distort_normalized({14, 0}).x();  // 1.4995 rad
    EXPECT_TRUE(c.undistorted_from_raw(c.pixel_from_normalized({just, 0})));
    for (const double farther : {1.02, 1.2, 2.0, 9.0}) {
      EXPECT_FALSE(c.undistorted_from_raw(c.pixel_from_normalized({farther * just, 0}))) << farther;
    }
  }
}

TEST(CameraModel, RefusesPastTheFold) {
  // Barrel distortion alone: r (1 - 0.3 r^2) has its maximum 0.70 at r = 1.05; no point is seen farther out.
  const CameraModel c = with(DistortionModel::kRadTan, {-0.3});
  const auto at = [&](double distorted) { return c.undistorted_from_raw(c.pixel_from_normalized({distorted, 0})); };
  ASSERT_TRUE(at(0.65));
  EXPECT_LT(c.normalized_from_pixel(*at(0.65)).x(), 1.05);
  for (const double distorted : {0.71, 0.75, 0.9, 1.5, 5.0}) EXPECT_FALSE(at(distorted)) << distorted;
}

TEST(CameraModel, RefusesRaysBesideAPinhole) {
  const CameraModel c = with(DistortionModel::kEquidistant, {});
  const auto at = [&](double angle_rad) { return c.undistorted_from_raw(c.pixel_from_normalized({0, angle_rad})); };
  EXPECT_TRUE(at(1.4));
  for (const double angle_rad : {1.55, 1.6, 3.0}) EXPECT_FALSE(at(angle_rad)) << angle_rad;
}

TEST(CameraModel, ProjectJacobianNumerically) {
  const CameraModel c = pinhole();
  constexpr double h = 1e-6;
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(0.3, -0.7, 2), Eigen::Vector3d(-4, 2, 5), Eigen::Vector3d(0, 0, 0.5)}) {
    const Eigen::Matrix<double, 2, 3> j = c.project_jacobian(p);
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d d = h * Eigen::Vector3d::Unit(i);
      EXPECT_THAT(j.col(i), VectorNear(((c.project(p + d) - c.project(p - d)) / (2 * h)).eval(), 1e-5 * j.norm()));
    }
  }
}

TEST(CameraModel, PixelAndNormalizedAreInverse) {
  const CameraModel c = pinhole();
  const Eigen::Vector2d px(12.5, 470.25);
  EXPECT_THAT(c.pixel_from_normalized(c.normalized_from_pixel(px)), VectorNear(px, 1e-10));
  EXPECT_THAT(c.project({0, 0, 3}), VectorNear(Eigen::Vector2d(c.cx, c.cy), 1e-12));
}

TEST(CameraModel, ContainsRawCountsPixelCentres) {
  const CameraModel c = pinhole();
  EXPECT_TRUE(c.contains_raw({0, 0}));
  EXPECT_TRUE(c.contains_raw({751, 479}));
  EXPECT_FALSE(c.contains_raw({751.1, 100}));
  EXPECT_FALSE(c.contains_raw({4.9, 100}, 5));
  EXPECT_FALSE(c.contains_raw({-0.1, 100}));
}

TEST(CameraModel, NamesWhatIsWrong) {
  EXPECT_FALSE(problem_of(pinhole()));
  const auto problem = [](auto change) {
    CameraModel c = pinhole();
    change(c);
    return problem_of(c).has_value();
  };
  EXPECT_TRUE(problem([](CameraModel& c) { c.width_px = 0; }));
  EXPECT_TRUE(problem([](CameraModel& c) { c.height_px = 100000; }));
  EXPECT_TRUE(problem([](CameraModel& c) { c.fx = 0; }));
  EXPECT_TRUE(problem([](CameraModel& c) { c.fy = -400; }));
  EXPECT_TRUE(problem([](CameraModel& c) { c.fx = std::numeric_limits<double>::quiet_NaN(); }));
  EXPECT_FALSE(problem([](CameraModel& c) { c.cx = 752; })) << "a region of the sensor";
  EXPECT_TRUE(problem([](CameraModel& c) { c.cx = 2000; }));
  EXPECT_TRUE(problem([](CameraModel& c) { c.cy = std::numeric_limits<double>::quiet_NaN(); }));
  EXPECT_TRUE(problem([](CameraModel& c) { c.distortion = DistortionModel::kOmni, c.coefficients[0] = -1; }));
  EXPECT_TRUE(problem([](CameraModel& c) { c.distortion = DistortionModel::kDoubleSphere, c.coefficients[1] = 1.2; }));
  EXPECT_TRUE(problem([](CameraModel& c) { c.coefficients[7] = std::numeric_limits<double>::infinity(); }));
}

}  // namespace
}  // namespace coslam::camera_model_test
