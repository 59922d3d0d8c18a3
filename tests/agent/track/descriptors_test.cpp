// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/descriptors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

namespace coslam::descriptors_test {
namespace {

constexpr double kBorderPx = 14;

// Spots of all sizes.
cv::Mat1b textured() {
  cv::Mat1f grey(360, 480, 0.0F);
  std::mt19937 random(5);
  cv::Mat1f noise(grey.size());
  for (const double sigma_px : {1.2, 2.5, 5.0, 10.0}) {
    for (float& v : noise) v = std::normal_distribution<float>(0, 1)(random);
    cv::Mat1f smooth;
    cv::GaussianBlur(noise, smooth, {}, sigma_px);
    grey += smooth * (2 * sigma_px * 20);
  }
  cv::Mat1b out;
  grey.convertTo(out, CV_8U, 1, 128);
  return out;
}

double distance(const std::uint8_t* a, const float* b) {
  double sum = 0;
  for (int k = 0; k < kDescriptorBytes; ++k) {
    sum += std::pow(static_cast<double>(a[k]) - quantised_descriptor(static_cast<std::uint8_t>(b[k])), 2);
  }
  return std::sqrt(sum);
}

class DescriptorsTest : public testing::Test {
 protected:
  const cv::Mat1b image_ = textured();
};

// Map files of before hold those of OpenCV, whose places are a quarter of a pixel to the lower right.
TEST_F(DescriptorsTest, TheyAreThoseOfOtherPrograms) {
  std::vector<cv::KeyPoint> theirs;
  cv::Mat described;
  cv::SIFT::create(0, 3, 0.015)->detectAndCompute(image_, {}, theirs, described);
  const DescribedFeatures ours = describe(image_, 300, kBorderPx);
  ASSERT_EQ(ours.raw_px.size(), 300U);
  int there = 0, alike = 0;
  for (std::size_t i = 0; i < ours.raw_px.size(); ++i) {
    bool found = false, same = false;
    for (std::size_t j = 0; j < theirs.size(); ++j) {
      const Eigen::Vector2f px(theirs[j].pt.x - 0.25F, theirs[j].pt.y - 0.25F);
      if ((px - ours.raw_px[i]).norm() > 0.3F) continue;
      found = true;
      same |= distance(&ours.descriptors[i * kDescriptorBytes], described.ptr<float>(static_cast<int>(j))) < 100;
    }
    there += found;
    alike += same;
  }
  EXPECT_GE(there, 280);
  EXPECT_GE(alike, 0.9 * there) << "of a length of 512";
}

TEST_F(DescriptorsTest, FeaturesAreFoundAgainInATurnedAndLargerImage) {
  const cv::Matx23d warp = cv::getRotationMatrix2D({240, 180}, 35, 1.3);
  cv::Mat1b turned;
  cv::warpAffine(image_, turned, warp, image_.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT_101);
  const DescribedFeatures a = describe(image_, 400, kBorderPx), b = describe(turned, 400, kBorderPx);
  int visible = 0, found = 0;
  for (std::size_t i = 0; i < a.raw_px.size(); ++i) {
    const cv::Vec2d at = warp * cv::Vec3d(a.raw_px[i].x(), a.raw_px[i].y(), 1);
    if (at[0] < 30 || at[1] < 30 || at[0] > 450 || at[1] > 330) continue;
    ++visible;
    std::size_t best = 0;
    double least = 1e9;
    for (std::size_t j = 0; j < b.raw_px.size(); ++j) {
      double d2 = 0;
      for (std::size_t k = 0; k < kDescriptorBytes; ++k) {
        d2 += std::pow(a.descriptors[i * kDescriptorBytes + k] - b.descriptors[j * kDescriptorBytes + k], 2);
      }
      if (d2 >= least) continue;
      least = d2;
      best = j;
    }
    found += std::hypot(b.raw_px[best].x() - at[0], b.raw_px[best].y() - at[1]) < 1.5;
  }
  EXPECT_GE(visible, 100);
  EXPECT_GE(found, 0.6 * visible);
}

TEST_F(DescriptorsTest, TheStrongestApartFromEachOtherAndFromTheEdge) {
  const DescribedFeatures few = describe(image_, 50, kBorderPx), more = describe(image_, 200, kBorderPx);
  ASSERT_EQ(few.raw_px.size(), 50U);
  ASSERT_EQ(few.descriptors.size(), 50U * kDescriptorBytes);
  ASSERT_EQ(more.raw_px.size(), 200U);
  for (std::size_t i = 0; i < more.raw_px.size(); ++i) {
    const Eigen::Vector2f& p = more.raw_px[i];
    if (i < 50) {
      EXPECT_EQ(p, few.raw_px[i]);
    }
    EXPECT_TRUE(p.x() >= kBorderPx && p.y() >= kBorderPx && p.x() <= 479 - kBorderPx && p.y() <= 359 - kBorderPx);
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE((p - more.raw_px[j]).norm(), 3);
  }
}

TEST_F(DescriptorsTest, OnlyNearWhereItIsAsked) {
  const DescribedFeatures all = describe(image_, 100, kBorderPx);
  const std::vector<Eigen::Vector2f> places{all.raw_px[3] + Eigen::Vector2f(2, 1), all.raw_px[70]};
  const DescribedFeatures near = describe_near(image_, places, 4, 100, kBorderPx);
  EXPECT_GE(near.raw_px.size(), 2U);
  for (const Eigen::Vector2f& p : near.raw_px) {
    EXPECT_LT(std::min((p - places[0]).norm(), (p - places[1]).norm()), 5);
  }
  EXPECT_EQ(near.raw_px[0], all.raw_px[3]) << "the strongest first";
}

TEST_F(DescriptorsTest, AnEmptyOrEvenImageHasNone) {
  EXPECT_TRUE(describe(cv::Mat1b(), 100, kBorderPx).raw_px.empty());
  EXPECT_TRUE(describe(cv::Mat1b(100, 100, std::uint8_t{77}), 100, kBorderPx).raw_px.empty());
}

}  // namespace
}  // namespace coslam::descriptors_test
