// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/align.h"

#include <gtest/gtest.h>

#include "agent/track/window.h"
#include "tests/support/synthetic_view.h"

namespace coslam::align_test {
namespace {

const cv::Size kImage(320, 240);

Pyramid pyramid_of(const cv::Mat& image, int levels = 5) {
  Pyramid p;
  p.build(image, levels);
  return p;
}

test::View shifted(double dx, double dy) {
  test::View v = test::View::at({400, 300}, 0, 1, kImage);
  v.plane_from_image(0, 2) -= dx;
  v.plane_from_image(1, 2) -= dy;
  return v;
}

TEST(Pyramid, RepeatsTheBorderAndHalves) {
  const cv::Size size(321, 240);
  const cv::Mat image = test::render(test::plane_texture(400, 300, 1), test::View::at({200, 150}, 0, 1, size), size);
  const Pyramid p = pyramid_of(image);
  ASSERT_EQ(p.levels(), 4);  // a fifth would be 15 pixels high
  EXPECT_EQ(p.level(1).cols(), 161);
  EXPECT_EQ(p.level(1).rows(), 120);
  EXPECT_EQ(*p.level(0).at(-20, 100), *p.level(0).at(0, 100));
  EXPECT_EQ(*p.level(0).at(320 + 20, -7), *p.level(0).at(320, 0));
  EXPECT_EQ(*p.level(2).at(5, p.level(2).rows() + 30), *p.level(2).at(5, p.level(2).rows() - 1));
}

TEST(Window, FindsItselfWithoutOffset) {
  const Pyramid p = pyramid_of(test::render(test::plane_texture(800, 600, 2), shifted(0, 0), kImage));
  const Eigen::Vector2f at(101.37F, 77.81F);
  WindowTemplate window;
  cut_template(p.level(0), at, window);
  const WindowStep step = window_step(p.level(0), at, window);
  EXPECT_LT(step.offset_px.norm(), 1e-2);
  EXPECT_NEAR(step.gain, 1.0, 1e-2);
  EXPECT_NEAR(window_zncc(p.level(0), at, window), 1.0, 1e-3);
}

TEST(Window, ExtremeContrastDoesNotOverflow) {
  cv::Mat stripes(240, 320, CV_8U);
  for (int y = 0; y < stripes.rows; ++y) {
    for (int x = 0; x < stripes.cols; ++x) stripes.at<std::uint8_t>(y, x) = ((x / 2 + y / 2) % 2) != 0 ? 255 : 0;
  }
  const Pyramid p = pyramid_of(stripes);
  WindowTemplate window;
  cut_template(p.level(0), {100, 100}, window);
  EXPECT_GT(window.squares, 0);
  EXPECT_GT(window.min_eigenvalue, 0);
  EXPECT_NEAR(window_zncc(p.level(0), {100, 100}, window), 1.0, 1e-3);
  EXPECT_NEAR(window_zncc(p.level(0), {102, 100}, window), -1.0, 1e-3);
}

TEST(Window, FlatWindowHasNoTextureAndNoCorrelation) {
  const Pyramid p = pyramid_of(cv::Mat(240, 320, CV_8U, cv::Scalar(90)));
  WindowTemplate window;
  cut_template(p.level(0), {100, 100}, window);
  EXPECT_EQ(window.min_eigenvalue, 0);
  EXPECT_EQ(window_zncc(p.level(0), {100, 100}, window), 0);
}

TEST(Align, RecoversSubPixelShiftUnderGainAndOffset) {
  const cv::Mat texture = test::plane_texture(800, 600, 3, false);
  const Pyramid from = pyramid_of(test::render(texture, shifted(0, 0), kImage));
  for (const Eigen::Vector2f& d :
       {Eigen::Vector2f(0.3F, -0.4F), Eigen::Vector2f(7.25F, 3.6F), Eigen::Vector2f(-14.4F, 8.7F)}) {
    test::View view = shifted(d.x(), d.y());
    view.gain = 0.8;
    view.offset = 10;
    const Pyramid to = pyramid_of(test::render(texture, view, kImage));
    for (int y = 60; y <= 180; y += 40) {
      for (int x = 60; x <= 260; x += 40) {
        const Eigen::Vector2f at(static_cast<float>(x) + 0.3F, static_cast<float>(y) + 0.6F);
        const WindowAlignment a = align(from, at, to, at, 4);
        ASSERT_TRUE(a.found) << at.transpose() << " by " << d.transpose();
        EXPECT_LT((a.px - at - d).norm(), 0.07) << at.transpose() << " by " << d.transpose();
        EXPECT_GT(a.zncc, 0.98);
      }
    }
  }
}

TEST(Align, TellsFlatSurroundings) {
  const Pyramid flat = pyramid_of(cv::Mat(240, 320, CV_8U, cv::Scalar(90)));
  EXPECT_FALSE(align(flat, {100, 100}, flat, {100, 100}, 4).found);
}

TEST(Align, BestGuessIsTheOneThatLooksAlike) {
  const cv::Mat texture = test::plane_texture(800, 600, 4);
  const Pyramid from = pyramid_of(test::render(texture, shifted(0, 0), kImage));
  const Pyramid to = pyramid_of(test::render(texture, shifted(45, -30), kImage));
  const Eigen::Vector2f at(150, 120), right = at + Eigen::Vector2f(43, -31);
  const std::array<Eigen::Vector2f, 3> guesses = {at, right, at - Eigen::Vector2f(40, 40)};
  const Guess guess = best_guess(from, at, to, guesses);
  EXPECT_EQ(guess.px, right);
  EXPECT_LT(guess.top, 4);
}

}  // namespace
}  // namespace coslam::align_test
