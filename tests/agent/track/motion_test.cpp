// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/motion.h"

#include <gtest/gtest.h>

#include "tests/support/synthetic_view.h"

namespace coslam::motion_test {
namespace {

TEST(GlobalShift, IsFoundWithoutAStartUnderOtherExposure) {
  const cv::Size size(640, 480);
  const cv::Mat texture = test::plane_texture(1000, 800, 1);
  test::View view = test::View::at({500, 400}, 0, 1, size);
  Pyramid from;
  from.build(test::render(texture, view, size), 5);
  for (const Eigen::Vector2d& d : {Eigen::Vector2d(0, 0), Eigen::Vector2d(70, -45), Eigen::Vector2d(-33, 12)}) {
    test::View moved = view;
    moved.plane_from_image(0, 2) -= d.x();
    moved.plane_from_image(1, 2) -= d.y();
    moved.gain = 0.7;
    moved.offset = 20;
    moved.noise = 4;
    Pyramid to;
    to.build(test::render(texture, moved, size), 5);
    EXPECT_LT((global_shift(from, to).cast<double>() - d).norm(), 6) << d.transpose();
  }
}

TEST(Middles, DifferByTheNoiseAloneWhereTheyShowTheSame) {
  const cv::Size size(640, 480);
  const cv::Mat texture = test::plane_texture(1000, 800, 1);
  test::View view = test::View::at({500, 400}, 0, 1, size);
  view.noise = 3;
  Pyramid a, b;
  a.build(test::render(texture, view, size, 1), 1);
  view.plane_from_image(0, 2) -= 2.5;
  b.build(test::render(texture, view, size, 2), 1);
  float same = 0, other = 0;
  for (float x = 40; x < 600; x += 20) {
    const Eigen::Vector2f at(x, 200);
    same += difference_of_middles(a.level(0), at, b.level(0), at + Eigen::Vector2f(2.5f, 0)) / 28;
    other += difference_of_middles(a.level(0), at, b.level(0), at) / 28;
  }
  EXPECT_NEAR(same, 14, 5);  // twice the noise's 9, less what interpolation takes away
  EXPECT_GT(other, 3 * same);
}

TEST(GlobalShift, IsNoneInAFlatImage) {
  Pyramid p;
  p.build(cv::Mat(480, 640, CV_8U, cv::Scalar(7)), 5);
  EXPECT_EQ(global_shift(p, p), Eigen::Vector2f(0, 0));
}

TEST(MotionField, OneStrangerAmongTheNearestDoesNotMatter) {
  MotionField field;
  EXPECT_TRUE(field.empty());
  for (int i = 0; i < 4; ++i) field.add({10.0F * static_cast<float>(i), 0}, {5, -3});
  field.add({12, 2}, {-40, 40});
  for (int i = 0; i < 20; ++i) field.add({500, 10.0F * static_cast<float>(i)}, {100, 100});
  EXPECT_EQ(field.near({11, 1}), Eigen::Vector2f(5, -3));
}

TEST(MotionField, TakesWhatThereIs) {
  MotionField field;
  field.add({1, 1}, {2, 3});
  EXPECT_EQ(field.near({300, 300}), Eigen::Vector2f(2, 3));
}

}  // namespace
}  // namespace coslam::motion_test
