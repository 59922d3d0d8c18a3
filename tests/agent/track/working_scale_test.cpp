// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/working_scale.h"

#include <gtest/gtest.h>

#include <vector>

#include "agent/track/tracker.h"
#include "tests/support/synthetic_view.h"

namespace coslam::working_scale_test {
namespace {

TEST(WorkingScale, StartsAtTheFinest) {
  const TrackerConfig config;
  for (const int width : {481, 512, 640, 752, 1241, 1280}) EXPECT_EQ(WorkingScale(width, config).now(), 1) << width;
  EXPECT_EQ(WorkingScale(376, config).now(), 2);
  EXPECT_DOUBLE_EQ(WorkingScale(1920, config).now(), 1280.0 / 1920);
  EXPECT_DOUBLE_EQ(WorkingScale(3840, config).now(), 1280.0 / 3840);
}

// What the images lose by being halved, image by image.
void see(WorkingScale* scale, double loss, int images) {
  for (int i = 0; i < images; ++i) {
    if (scale->due()) scale->compared(loss);
  }
}

TEST(WorkingScale, WhatShowsLittleDetailIsTrackedSmaller) {
  struct {
    int width_px;
    double coarse;
  } const cases[] = {{3840, 1.0 / 5}, {1920, 1.0 / 3},    {1504, 0.5}, {1280, 0.5},
                     {960, 0.5},      {752, 480.0 / 752}, {640, 0.75}};
  for (const auto& c : cases) {
    WorkingScale scale(c.width_px, {});
    see(&scale, 1.1, 10);
    EXPECT_DOUBLE_EQ(scale.now(), c.coarse) << c.width_px;
  }
}

TEST(WorkingScale, SmallImagesHaveOneSizeAlone) {
  for (const int width : {320, 480, 500, 590}) {
    WorkingScale scale(width, {});
    for (int i = 0; i < 100; ++i) EXPECT_FALSE(scale.due());
  }
}

TEST(WorkingScale, OneImageDecidesNothing) {
  WorkingScale scale(1280, {});
  see(&scale, 1.0, 1);
  see(&scale, 2.0, 20);
  EXPECT_EQ(scale.now(), 1);
  see(&scale, 1.0, 30);
  EXPECT_EQ(scale.now(), 1);
  see(&scale, 1.0, 600);
  EXPECT_EQ(scale.now(), 0.5) << "the light went";
  see(&scale, 1.28, 3000);
  EXPECT_EQ(scale.now(), 0.5) << "neither here nor there";
  see(&scale, 1.9, 600);
  EXPECT_EQ(scale.now(), 1) << "and came back";
}

class LossByHalving : public testing::Test {
 protected:
  cv::Mat image(int frame, double gain, double noise, double blur_px) const {
    test::View view = test::View::at({400 + 2.3 * frame, 300 + 1.1 * frame}, 0, 1, kSize);
    cv::Mat out = test::render(texture_, view, kSize, 1);
    if (blur_px > 0) cv::GaussianBlur(out, out, {}, blur_px);
    cv::Mat seen, added(out.size(), CV_32F);
    out.convertTo(seen, CV_32F, gain);
    cv::RNG rng(static_cast<std::uint64_t>(frame + 1));
    rng.fill(added, cv::RNG::NORMAL, 0, noise);
    seen += added;
    seen.convertTo(out, CV_8U);
    return out;
  }

  std::optional<double> loss(double gain, double noise, double blur_px) const {
    const cv::Mat before = image(0, gain, noise, blur_px), newest = image(1, gain, noise, blur_px);
    Tracker tracker({});
    std::vector<Track> from = tracker.step(before);
    std::vector<MovedPlace> places;
    for (const Track& t : tracker.step(newest)) {
      for (const Track& f : from) {
        if (f.id == t.id) places.push_back({f.raw_px, t.raw_px});
      }
    }
    return loss_by_halving(before, newest, places);
  }

  const cv::Size kSize{640, 480};
  const cv::Mat texture_ = test::plane_texture(900, 700, 4);
};

TEST_F(LossByHalving, ASharpImageLosesMuch) { EXPECT_GT(loss(1, 0.5, 0).value_or(0), 1.6); }

TEST_F(LossByHalving, ANoisyOrSoftOneLosesLittle) {
  const double sharp = loss(1, 1, 0).value_or(0);
  EXPECT_LT(loss(0.15, 3, 0).value_or(9), 1.3) << "dim";
  EXPECT_LT(loss(1, 1, 2.5).value_or(9), 1.3) << "soft";
  EXPECT_LT(loss(1, 1, 1).value_or(9), sharp);
}

TEST_F(LossByHalving, OneImageTwiceTellsNothing) {
  const cv::Mat once = image(0, 1, 1, 0);
  std::vector<MovedPlace> places;
  Tracker tracker({});
  for (const Track& t : tracker.step(once)) places.push_back({t.raw_px, t.raw_px});
  ASSERT_GT(places.size(), 100U);
  EXPECT_FALSE(loss_by_halving(once, once, places));
  EXPECT_FALSE(loss_by_halving(once, image(1, 1, 1, 0), {})) << "nor does none";
}

TEST(ScaledImage, IsWhereItWas) {
  const cv::Mat texture = test::plane_texture(500, 400, 2);
  const cv::Size size(400, 300);
  const cv::Mat whole = test::render(texture, test::View::at({250, 200}, 0, 1, size), size, 1);
  for (const double scale : {2.0, 0.75, 0.5, 0.3}) {
    const cv::Mat scaled = scaled_image(whole, scale);
    EXPECT_EQ(scaled.cols, std::lround(400 * scale));
    const cv::Size small(scaled.cols, scaled.rows);
    const cv::Mat expected = test::render(texture, test::View::at({250, 200}, 0, scale, small), small, 1);
    EXPECT_LT(cv::norm(scaled, expected, cv::NORM_L1) / static_cast<double>(scaled.total()), 3.0) << scale;
  }
}

}  // namespace
}  // namespace coslam::working_scale_test
