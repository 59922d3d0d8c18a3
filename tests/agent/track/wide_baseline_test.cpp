// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/wide_baseline.h"

#include <gtest/gtest.h>

#include "tests/support/synthetic_view.h"

namespace coslam::wide_baseline_test {
namespace {

const cv::Size kImage(640, 480);
const cv::Point2d kMiddle(600, 500);

cv::Mat seen(const cv::Mat& texture, test::View view, std::uint64_t noise_seed) {
  view.noise = 2;
  return test::render(texture, view, kImage, noise_seed);
}

TEST(WideBaseline, HalfAnImageFartherPlacesAreFound) {
  const cv::Mat texture = test::plane_texture(1400, 1000, 3);
  const test::View from = test::View::at(kMiddle, 0, 1, kImage);
  const test::View to = test::View::at({kMiddle.x + 260, kMiddle.y - 130}, 0, 1, kImage);
  MotionField motions = wide_baseline_motion(seen(texture, from, 1), seen(texture, to, 2));
  ASSERT_GT(motions.size(), 30U);
  for (float x = 300; x < 600; x += 50) {
    EXPECT_LT((motions.near({x, 200}) - Eigen::Vector2f(-260, 130)).norm(), 1.5f) << x;
  }
}

TEST(WideBaseline, ATurnOfTheImageDoesNotMatter) {
  const cv::Mat texture = test::plane_texture(1400, 1000, 4);
  const test::View from = test::View::at(kMiddle, 0, 1, kImage);
  const test::View to = test::View::at({kMiddle.x + 60, kMiddle.y}, 0.7, 1.1, kImage);
  MotionField motions = wide_baseline_motion(seen(texture, from, 1), seen(texture, to, 2));
  ASSERT_GT(motions.size(), 50U);
  const Eigen::Vector2d at(330, 230);
  const Eigen::Vector2d true_motion_px = to.image_px(from.plane_px(at)) - at;
  EXPECT_LT((motions.near(at.cast<float>()).cast<double>() - true_motion_px).norm(), 20) << "of five neighbours";
}

TEST(WideBaseline, OfAnotherPlaceNextToNothingIsFound) {
  const test::View view = test::View::at(kMiddle, 0, 1, kImage);
  const cv::Mat one = seen(test::plane_texture(1400, 1000, 5), view, 1);
  const cv::Mat other = seen(test::plane_texture(1400, 1000, 6), view, 2);
  EXPECT_LT(wide_baseline_motion(one, other).size(), 15U);
  EXPECT_TRUE(wide_baseline_motion(one, cv::Mat(kImage, CV_8U, cv::Scalar(90))).empty());
}

}  // namespace
}  // namespace coslam::wide_baseline_test
