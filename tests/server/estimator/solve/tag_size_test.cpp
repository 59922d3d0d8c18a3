// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/tag_size.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "tests/support/sim_world.h"

namespace coslam::tag_size_test {
namespace {

using Eigen::Vector3d;

constexpr double kSide = 0.2, kNoise_px = 0.3;
const Vector3d kMiddle(0.1, -0.1, 2.0);

using Corners = std::array<Vector3d, 4>;

// Turned a little away from the cameras.
Corners tag_at(const Vector3d& middle, double side = kSide) {
  const Eigen::Matrix3d turn(Eigen::AngleAxisd(0.4, Vector3d(0.2, 1, 0.1).normalized()));
  const double h = side / 2;
  return {middle + turn * Vector3d(-h, -h, 0), middle + turn * Vector3d(h, -h, 0), middle + turn * Vector3d(h, h, 0),
          middle + turn * Vector3d(-h, h, 0)};
}

class TagSizes : public ::testing::Test {
 protected:
  TagView view(const Vector3d& center, const Corners& corners, int camera = 0) {
    TagView v{CameraId(static_cast<std::uint16_t>(camera)), &model_, test::looking(center), {}, 1.5};
    for (std::size_t k = 0; k < 4; ++k) {
      v.undistorted_px[k] = model_.project(v.cam_from_world * corners[k]);
      v.undistorted_px[k] += kNoise_px * Eigen::Vector2d(normal_(random_), normal_(random_));
    }
    return v;
  }
  // Along a line of that length across the view.
  std::vector<TagView> pass(double length, int views, const Corners& corners = tag_at(kMiddle), int camera = 0) {
    std::vector<TagView> out;
    for (int i = 0; i < views; ++i) {
      const double s = views == 1 ? 0 : static_cast<double>(i) / (views - 1) - 0.5;
      out.push_back(view({length * s, 0.1 * length * s, 0.1 * length * std::sin(6 * s)}, corners, camera));
    }
    return out;
  }

  std::mt19937_64 random_{3};
  std::normal_distribution<double> normal_;
  CameraModel model_ = test::sim_camera();
};

TEST_F(TagSizes, MeasuredWithinItsUncertainty) {
  double squares = 0;
  constexpr int kTrials = 200;
  for (int i = 0; i < kTrials; ++i) {
    const TagSize s = measure_tag(pass(0.8, 12), {});
    ASSERT_EQ(s.status, TagStatus::kOk);
    EXPECT_NEAR(s.side, kSide, 0.01 * kSide);
    EXPECT_LT(s.sigma, 0.01 * kSide);
    squares += std::pow((s.side - kSide) / s.sigma, 2) / kTrials;
  }
  EXPECT_LT(squares, 1.2) << "never surer than it is right";
  EXPECT_GT(squares, 0.03);
}

TEST_F(TagSizes, TwoCamerasAtOneInstantAreEnough) {
  const Corners corners = tag_at(kMiddle);
  const TagSize s = measure_tag(std::vector{view({-0.4, 0, 0}, corners, 0), view({0.4, 0, 0}, corners, 1)}, {});
  ASSERT_EQ(s.status, TagStatus::kOk);
  EXPECT_NEAR(s.side, kSide, 4 * s.sigma);
  EXPECT_LT(s.sigma, 0.02 * kSide);
}

TEST_F(TagSizes, WithoutParallaxNothingIsSaid) {
  for (const double length : {0.0, 0.002, 0.01}) {
    const TagSize s = measure_tag(pass(length, 60), {});
    EXPECT_TRUE(s.status == TagStatus::kUndetermined || s.sigma > 0.05 * s.side) << length;
  }
  EXPECT_EQ(measure_tag({}, {}).status, TagStatus::kUndetermined);
  EXPECT_EQ(measure_tag(pass(0, 1), {}).status, TagStatus::kUndetermined);
}

TEST_F(TagSizes, ManyViewsOfOneCameraCountForTwo) {
  const double few = measure_tag(pass(0.5, 6), {}).sigma, many = measure_tag(pass(0.5, 60), {}).sigma;
  EXPECT_GT(many, 0.7 * few);
  auto both = pass(0.5, 30);
  for (const TagView& v : pass(0.5, 30, tag_at(kMiddle), 1)) both.push_back(v);
  EXPECT_LT(measure_tag(both, {}).sigma, 0.85 * many);
}

TEST_F(TagSizes, AFewWrongViewsAreLeftOut) {
  auto views = pass(0.8, 20);
  for (const std::size_t i : {3U, 11U}) {
    for (auto& px : views[i].undistorted_px) px += Eigen::Vector2d(15, -9);
  }
  const TagSize s = measure_tag(views, {});
  ASSERT_EQ(s.status, TagStatus::kOk);
  EXPECT_EQ(s.views, 18);
  EXPECT_NEAR(s.side, kSide, 0.01 * kSide);
}

TEST_F(TagSizes, PrintedTwiceOrMovedIsNotOnePlace) {
  auto views = pass(0.8, 10);
  for (const TagView& v : pass(0.8, 6, tag_at(kMiddle + Vector3d(0.5, 0, 0.3)))) views.push_back(v);
  EXPECT_EQ(measure_tag(views, {}).status, TagStatus::kNotOnePlace);
  std::vector<TagView> moving;
  for (int i = 0; i < 20; ++i)
    moving.push_back(view({-0.4 + 0.04 * i, 0, 0}, tag_at(kMiddle + Vector3d(0, 0.01 * i, 0.02 * i))));
  EXPECT_EQ(measure_tag(moving, {}).status, TagStatus::kNotOnePlace);
}

TEST_F(TagSizes, AnOblongIsNoSquare) {
  Corners oblong = tag_at(kMiddle);
  oblong[1] += 0.15 * (oblong[1] - oblong[0]);
  oblong[2] += 0.15 * (oblong[2] - oblong[3]);
  EXPECT_EQ(measure_tag(pass(0.8, 12, oblong), {}).status, TagStatus::kNotSquare);
  Corners kite = tag_at(kMiddle);
  kite[2] = kMiddle + 1.3 * (kite[2] - kMiddle);
  EXPECT_EQ(measure_tag(pass(0.8, 12, kite), {}).status, TagStatus::kNotSquare);
}

TEST_F(TagSizes, FollowsTheScaleOfTheMap) {
  const TagSize metric = measure_tag(pass(0.8, 12), {});
  auto views = pass(0.8, 12);
  for (TagView& v : views) v.cam_from_world.translation *= 7;
  const TagSize scaled = measure_tag(views, {});
  EXPECT_NEAR(scaled.side, 7 * kSide, 0.05 * kSide);
  EXPECT_NEAR(scaled.sigma, 7 * metric.sigma, 2 * metric.sigma);
}

}  // namespace
}  // namespace coslam::tag_size_test
