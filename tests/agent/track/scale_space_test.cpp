// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/scale_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "agent/track/scale_kernels.h"

namespace coslam::scale_space_test {
namespace {

constexpr float kLeast = 0.005F;

struct Spot {
  double x_px, y_px, sigma_px, height;
};

cv::Mat1b image_of(const std::vector<Spot>& spots, int width = 160, int height = 120) {
  cv::Mat1b out(height, width);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double grey = 120;
      for (const Spot& s : spots) {
        grey +=
            s.height * std::exp(-0.5 * (std::pow(x - s.x_px, 2) + std::pow(y - s.y_px, 2)) / std::pow(s.sigma_px, 2));
      }
      out(y, x) = static_cast<std::uint8_t>(std::lround(grey));
    }
  }
  return out;
}

TEST(ScaleSpaceTest, ABlobIsFoundWhereItIsAndAsLargeAsItIs) {
  for (const double sigma_px : {1.5, 2.0, 3.1, 5.0, 9.0}) {
    for (const double height : {100.0, -80.0}) {
      const Spot spot{80.3, 61.8, sigma_px, height};
      std::vector<Blob> found = find_blobs(scale_space(image_of({spot})), kLeast);
      ASSERT_FALSE(found.empty()) << sigma_px;
      const Blob& best = *std::ranges::max_element(found, {}, &Blob::contrast);
      EXPECT_NEAR(best.x_px, spot.x_px, 0.1) << sigma_px;
      EXPECT_NEAR(best.y_px, spot.y_px, 0.1) << sigma_px;
      // A difference of two blurs tells of the one between them.
      const double blur_px = best.sigma_px * std::exp2(best.octave - 1 + 1.0 / (2 * kScalesPerOctave));
      EXPECT_NEAR(blur_px / sigma_px, 1, 0.1) << sigma_px;
    }
  }
}

TEST(ScaleSpaceTest, EachBlobIsFound) {
  const std::vector<Spot> spots{{40, 40, 1.6, 90}, {90.5, 30.2, 3, -90}, {60, 90, 5, 60}, {125, 80, 2.5, 80}};
  std::vector<Blob> found = find_blobs(scale_space(image_of(spots)), kLeast);
  for (const Spot& s : spots) {
    const auto there = std::ranges::count_if(
        found, [&](const Blob& b) { return std::hypot(b.x_px - s.x_px, b.y_px - s.y_px) < 0.5 && b.contrast > 0.02F; });
    EXPECT_GE(there, 1) << s.x_px;
  }
}

TEST(ScaleSpaceTest, AnEdgeIsNoBlobNorIsWhatIsFaint) {
  cv::Mat1b edge(120, 160, std::uint8_t{60});
  edge.colRange(80, 160) = 200;
  EXPECT_TRUE(find_blobs(scale_space(edge), kLeast).empty());
  EXPECT_TRUE(find_blobs(scale_space(image_of({{80, 60, 3, 2}})), kLeast).empty());
  EXPECT_TRUE(find_blobs(scale_space(cv::Mat1b()), kLeast).empty());
  for (const int side : {1, 3, 8, 12}) {
    EXPECT_TRUE(find_blobs(scale_space(cv::Mat1b(side, side, std::uint8_t{9})), kLeast).empty()) << side;
  }
}

TEST(ScaleSpaceTest, NothingIsFoundOutsideTheMask) {
  const ScaleSpace space = scale_space(image_of({{40, 40, 2.5, 90}, {90, 40, 2.5, 90}}));
  cv::Mat1b mask(120, 160, std::uint8_t{0});
  mask(cv::Rect(80, 30, 20, 20)) = 255;
  const std::vector<Blob> found = find_blobs(space, 0.02F, mask);
  ASSERT_FALSE(found.empty());
  for (const Blob& b : found) EXPECT_NEAR(b.x_px, 90, 0.1);
}

TEST(ScaleKernelsTest, EveryBuildGivesTheSameBits) {
  const ScaleKernels* fast = avx2_scale_kernels();
  if (fast == nullptr) GTEST_SKIP() << "this processor has no AVX2";
  constexpr int kCount = 203;
  std::mt19937 random(3);
  std::vector<std::vector<std::int16_t>> rows(2 * kMostBlurRadius + 1, std::vector<std::int16_t>(kCount + 2));
  std::vector<const std::int16_t*> taps;
  for (auto& row : rows) {
    for (std::int16_t& v : row)
      v = static_cast<std::int16_t>(std::uniform_int_distribution(-128 * kGreyUnit, 127 * kGreyUnit)(random));
    taps.push_back(row.data());
  }
  for (int radius = 1; radius <= kMostBlurRadius; ++radius) {
    std::array<std::int16_t, kMostBlurRadius + 1> weights{};
    weights[0] = 32767;
    for (int k = 1; k <= radius; ++k) {
      weights[static_cast<std::size_t>(k)] = static_cast<std::int16_t>(1500 - 97 * k);
      weights[0] = static_cast<std::int16_t>(weights[0] - 2 * weights[static_cast<std::size_t>(k)]);
    }
    std::vector<std::int16_t> a(kCount), b(kCount);
    portable_scale_kernels().blur(taps.data(), weights.data(), radius, kCount, a.data());
    fast->blur(taps.data(), weights.data(), radius, kCount, b.data());
    EXPECT_EQ(a, b) << radius;
  }
  for (auto& row : rows) {
    for (std::int16_t& v : row) v = static_cast<std::int16_t>(std::uniform_int_distribution(-9, 9)(random));
  }
  std::vector<std::uint8_t> a(kCount), b(kCount);
  portable_scale_kernels().extrema(taps.data(), 4, kCount, a.data());
  fast->extrema(taps.data(), 4, kCount, b.data());
  EXPECT_EQ(a, b);
  EXPECT_GT(std::ranges::count(a, 1), 0);
}

TEST(ScaleKernelsTest, AnEvenImageStaysAsItIs) {
  const std::vector<std::int16_t> row(64, 127 * kGreyUnit);
  const std::vector<const std::int16_t*> taps(5, row.data());
  const std::array<std::int16_t, 3> weights{32768 - 2 * (7000 + 3000), 7000, 3000};
  std::vector<std::int16_t> out(64);
  portable_scale_kernels().blur(taps.data(), weights.data(), 2, 64, out.data());
  for (const std::int16_t v : out) EXPECT_NEAR(v, 127 * kGreyUnit, 1);
}

}  // namespace
}  // namespace coslam::scale_space_test
