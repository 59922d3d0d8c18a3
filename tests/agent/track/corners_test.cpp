// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/corners.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/support/synthetic_view.h"

namespace coslam::corners_test {
namespace {

const cv::Size kImage(640, 480);

cv::Mat plane_image(std::uint64_t seed, bool outlines = true) {
  return test::render(test::plane_texture(640, 480, seed, outlines), test::View::at({320, 240}, 0, 1, kImage), kImage);
}

std::vector<Eigen::Vector2f> corners_of(const cv::Mat& image, int wanted = 300,
                                        const std::vector<Eigen::Vector2f>& live = {},
                                        const CornerConfig& config = {}) {
  Pyramid p;
  p.build(image, 3);
  CornerFinder finder(config, image.cols, image.rows, 1);
  CornerScore score;
  const std::vector<CornerCell> cells = finder.cells();
  return finder.find([&](std::size_t i) { return corners_in(cells[i], p.level(1), score); }, live, {}, wanted);
}

// Number of corners in each of 6 x 8 parts of the image.
std::array<int, 48> coverage(const std::vector<Eigen::Vector2f>& corners) {
  std::array<int, 48> counts{};
  for (const Eigen::Vector2f& c : corners)
    ++counts.at(static_cast<std::size_t>(c.y()) / 80 * 8 + static_cast<std::size_t>(c.x()) / 80);
  return counts;
}

TEST(Corners, CoverTheImageEvenlyAndKeepTheirDistance) {
  const auto corners = corners_of(plane_image(1));
  EXPECT_GE(corners.size(), 250U);
  for (const int count : coverage(corners)) {
    EXPECT_GE(count, 2);
    EXPECT_LE(count, 14);
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE((corners[i] - corners[j]).norm(), 12 - 1e-3);
    EXPECT_GE(corners[i].minCoeff(), 11);
  }
}

TEST(Corners, DarkPartsAreCoveredToo) {
  cv::Mat image = plane_image(2, false);
  cv::Mat dark = image(cv::Rect(0, 0, 320, 480));
  dark.convertTo(dark, -1, 0.2, 3);
  for (const int count : coverage(corners_of(image))) EXPECT_GE(count, 1);
}

TEST(Corners, NoiseHasNone) {
  cv::Mat noise(kImage, CV_32F, cv::Scalar(100));
  cv::Mat grain(kImage, CV_32F);
  cv::RNG(3).fill(grain, cv::RNG::NORMAL, 0, 5);
  cv::Mat image;
  noise = noise + grain;
  noise.convertTo(image, CV_8U);
  EXPECT_TRUE(corners_of(image).empty());
  EXPECT_TRUE(corners_of(cv::Mat(kImage, CV_8U, cv::Scalar(30))).empty());
}

TEST(Corners, SitOnTheCrossingsOfACheckerboard) {
  cv::Mat image(kImage, CV_32F);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) image.at<float>(y, x) = (x / 64 + y / 64) % 2 != 0 ? 200.0F : 60.0F;
  }
  cv::GaussianBlur(image, image, cv::Size(), 1.0);
  image.convertTo(image, CV_8U);
  const auto corners = corners_of(image);
  EXPECT_EQ(corners.size(), 9U * 7U);
  for (const Eigen::Vector2f& c : corners) {
    const Eigen::Vector2f crossing = ((c.array() + 0.5F) / 64).round() * 64 - 0.5F;
    EXPECT_LT((c - crossing).norm(), 0.5) << c.transpose();
  }
}

TEST(Corners, ComeWhereNoTrackLives) {
  std::vector<Eigen::Vector2f> live;
  for (int y = 20; y < 480; y += 20) {
    for (int x = 20; x < 320; x += 20) live.emplace_back(x, y);
  }
  const auto corners = corners_of(plane_image(4), 20, live);
  ASSERT_EQ(corners.size(), 20U);
  for (const Eigen::Vector2f& c : corners) EXPECT_GT(c.x(), 310);
}

TEST(Corners, AreAsManyInTheFreePartOfAnImageAndThereforeCloser) {
  cv::Mat image = plane_image(6);
  image.rowRange(216, 480).setTo(128);
  const std::size_t sparse = corners_of(image, 1000).size();
  const auto dense = corners_of(image, 1000, {}, {.free_share = 0.45F});
  EXPECT_GT(static_cast<double>(dense.size()), 1.3 * static_cast<double>(sparse));
  for (std::size_t i = 0; i < dense.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE((dense[i] - dense[j]).norm(), 8);
  }
}

TEST(Corners, FindNoMoreThanWanted) {
  EXPECT_EQ(corners_of(plane_image(5), 7).size(), 7U);
  EXPECT_TRUE(corners_of(plane_image(5), 0).empty());
}

}  // namespace
}  // namespace coslam::corners_test
