// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace coslam::kernels_test {
namespace {

constexpr int kSide = 96;

// Noise, blacks and whites: the largest values that sums may have.
class KernelsTest : public testing::TestWithParam<int> {
 protected:
  KernelsTest() : image_(static_cast<std::size_t>(kSide) * kSide) {
    const int contrast = GetParam();
    for (std::uint8_t& p : image_) {
      const int grey = 128 + std::uniform_int_distribution(-contrast, contrast)(random_);
      p = static_cast<std::uint8_t>(contrast == 128 ? (grey > 128 ? 255 : 0) : grey);
    }
  }

  FirstSample first_sample() {
    std::array<int, 3> cuts{};
    for (int& c : cuts) c = std::uniform_int_distribution(0, kWeightSum)(random_);
    if (random_() % 8 == 0) cuts.fill(random_() % 2 == 0 ? 0 : kWeightSum);  // whole pixels
    std::ranges::sort(cuts);
    const int x = std::uniform_int_distribution(0, kSide - 32)(random_);
    const int y = std::uniform_int_distribution(0, kSide - 32)(random_);
    return {.pixel = image_.data() + y * kSide + x,
            .stride = kSide,
            .w00 = static_cast<std::uint16_t>(cuts[0]),
            .w01 = static_cast<std::uint16_t>(cuts[1] - cuts[0]),
            .w10 = static_cast<std::uint16_t>(cuts[2] - cuts[1]),
            .w11 = static_cast<std::uint16_t>(kWeightSum - cuts[2])};
  }
  // Turned and scaled about the middle of the image.
  WarpedSample warped_sample() {
    const double most = random_() % 2 == 0 ? 3 : 0.1;  // most tracks are hardly turned
    const double turn = std::uniform_real_distribution<>(-most, most)(random_);
    const double scale = std::uniform_real_distribution<>(0.6, 1.4)(random_);
    const auto fixed = [](double v) { return static_cast<int>(std::lround(v * 65536)); };
    const double c = scale * std::cos(turn), s = scale * std::sin(turn);
    const double x = 0.3 - kWindowHalf_px * (c - s), y = -0.2 - kWindowHalf_px * (s + c);
    return {.origin = image_.data() + kSide / 2 * kSide + kSide / 2,  // coordinates on both sides of it
            .stride = kSide,
            .x = fixed(x),
            .y = fixed(y),
            .x_u = fixed(c),
            .y_u = fixed(s),
            .x_v = fixed(-s),
            .y_v = fixed(c)};
  }

  std::mt19937 random_{7};
  std::vector<std::uint8_t> image_;
};

template <class Sums>
void expect_same(const Sums& a, const Sums& b) {
  static_assert(std::has_unique_object_representations_v<Sums>);
  const auto* x = reinterpret_cast<const int*>(&a);
  const auto* y = reinterpret_cast<const int*>(&b);
  for (std::size_t i = 0; i < sizeof(Sums) / sizeof(int); ++i) EXPECT_EQ(x[i], y[i]) << "sum " << i;
}

TEST_P(KernelsTest, OfEachVectorUnitGiveTheSameBits) {
  const Kernels* fast = vector_kernels();
  if (fast == nullptr) GTEST_SKIP() << "this processor has neither AVX2 nor NEON";
  const Kernels& plain = portable_kernels();
  for (int i = 0; i < 200; ++i) {
    Samples grey{}, dx{}, dy{}, fast_grey{}, fast_dx{}, fast_dy{};
    const FirstSample from = first_sample(), to = first_sample();
    const WarpedSample turned = warped_sample();
    expect_same(plain.cut(from, grey.data(), dx.data(), dy.data()),
                fast->cut(from, fast_grey.data(), fast_dx.data(), fast_dy.data()));
    ASSERT_EQ(grey, fast_grey);
    ASSERT_EQ(dx, fast_dx);
    ASSERT_EQ(dy, fast_dy);
    expect_same(plain.step(to, grey.data(), dx.data(), dy.data()), fast->step(to, grey.data(), dx.data(), dy.data()));
    expect_same(plain.correlate(to, grey.data()), fast->correlate(to, grey.data()));
    expect_same(plain.warped(turned, grey.data(), dx.data(), dy.data()),
                fast->warped(turned, grey.data(), dx.data(), dy.data()));
    if (HasFailure()) return;
  }
}

// By what they are said to be, sample for sample.
TEST_P(KernelsTest, SumUpWhatIsThere) {
  for (int i = 0; i < 20; ++i) {
    const FirstSample first = first_sample();
    const auto at = [&](int row, int column) {
      const std::uint8_t* p = first.pixel + row * kSide + column;
      return ((p[0] * first.w00 + p[1] * first.w01 + p[kSide] * first.w10 + p[kSide + 1] * first.w11) >> kWeightShift) -
             kSampleCentre;
    };
    Samples grey{}, dx{}, dy{};
    const TemplateSums sums = kernels().cut(first, grey.data(), dx.data(), dy.data());
    int total = 0, dx_dy = 0;
    for (int row = 0; row < kWindowSide; ++row) {
      for (int column = 0; column < kWindowSide; ++column) {
        const auto k = static_cast<std::size_t>(row * kWindowSide + column);
        ASSERT_EQ(grey[k], at(row + 1, column + 1) >> kTemplateShift);
        ASSERT_EQ(dx[k], (at(row + 1, column + 2) - at(row + 1, column)) >> (kTemplateShift + 1));
        ASSERT_EQ(dy[k], (at(row + 2, column + 1) - at(row, column + 1)) >> (kTemplateShift + 1));
        total += grey[k];
        dx_dy += dx[k] * dy[k];
      }
    }
    EXPECT_EQ(sums.grey, total);
    EXPECT_EQ(sums.dx_dy, dx_dy);
  }
}

INSTANTIATE_TEST_SUITE_P(Contrast, KernelsTest, testing::Values(3, 60, 127, 128));

}  // namespace
}  // namespace coslam::kernels_test
