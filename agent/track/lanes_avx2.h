// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <immintrin.h>

#include <cstdint>

#include "agent/track/kernels.h"

// Lanes of kernels_vector.cpp by AVX2. Everything is of that one file: the linker must not take it for another's.
namespace coslam {
namespace {

bool has_lanes() { return __builtin_cpu_supports("avx2") != 0; }

// The 16 samples of a row, 16 bits each.
struct Lanes {
  __m256i v;
};

Lanes load(const std::int16_t* p) { return {_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p))}; }
void store(std::int16_t* p, Lanes a) { _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), a.v); }
Lanes same(std::int16_t value) { return {_mm256_set1_epi16(value)}; }
Lanes operator-(Lanes a, Lanes b) { return {_mm256_sub_epi16(a.v, b.v)}; }
template <int kBits>
Lanes shifted_down(Lanes a) {
  return {_mm256_srai_epi16(a.v, kBits)};
}
// (a * b + 2^14) >> 15
Lanes rounded_product(Lanes a, Lanes b) { return {_mm256_mulhrs_epi16(a.v, b.v)}; }

// Adds up products.
class Sum {
 public:
  void add(Lanes a, Lanes b) { lanes_ = _mm256_add_epi32(lanes_, _mm256_madd_epi16(a.v, b.v)); }
  void add(Lanes a) { add(a, same(1)); }
  int get() const {
    __m128i s = _mm_add_epi32(_mm256_castsi256_si128(lanes_), _mm256_extracti128_si256(lanes_, 1));
    s = _mm_add_epi32(s, _mm_shuffle_epi32(s, 0x4e));
    s = _mm_add_epi32(s, _mm_shuffle_epi32(s, 0xb1));
    return _mm_cvtsi128_si32(s);
  }

 private:
  __m256i lanes_ = _mm256_setzero_si256();
};

__m256i pixels(const std::uint8_t* p) {
  return _mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
}

// A row of 16 pixels, and the same one pixel to the right.
struct Pixels {
  explicit Pixels(const std::uint8_t* p) : here(pixels(p)), right(pixels(p + 1)) {}
  __m256i here, right;
};

// 19 pixels.
struct WidePixels {
  explicit WidePixels(const std::uint8_t* p) : columns{pixels(p), pixels(p + 1), pixels(p + 2), pixels(p + 3)} {}
  __m256i columns[4];
};

// A row of samples, one more on either side.
struct WideLanes {
  Lanes before, middle, after;
};

constexpr bool blends(const FirstSample& /*first*/) { return true; }

// Interpolates between two rows.
class Blend {
 public:
  explicit Blend(const FirstSample& first)
      : w00_(_mm256_set1_epi16(static_cast<short>(first.w00))),
        w01_(_mm256_set1_epi16(static_cast<short>(first.w01))),
        w10_(_mm256_set1_epi16(static_cast<short>(first.w10))),
        w11_(_mm256_set1_epi16(static_cast<short>(first.w11))) {}

  Lanes between(const Pixels& upper, const Pixels& lower) const {
    return samples(upper.here, upper.right, lower.here, lower.right);
  }
  WideLanes between(const WidePixels& upper, const WidePixels& lower) const {
    const auto from = [&](int i) {
      return samples(upper.columns[i], upper.columns[i + 1], lower.columns[i], lower.columns[i + 1]);
    };
    return {from(0), from(1), from(2)};
  }

 private:
  Lanes samples(__m256i p00, __m256i p01, __m256i p10, __m256i p11) const {
    const __m256i above = _mm256_add_epi16(_mm256_mullo_epi16(p00, w00_), _mm256_mullo_epi16(p01, w01_));
    const __m256i below = _mm256_add_epi16(_mm256_mullo_epi16(p10, w10_), _mm256_mullo_epi16(p11, w11_));
    return {_mm256_sub_epi16(_mm256_srli_epi16(_mm256_add_epi16(above, below), kWeightShift),
                             _mm256_set1_epi16(kSampleCentre))};
  }

  __m256i w00_, w01_, w10_, w11_;
};

// Eight samples at these coordinates, in lanes of 32 bits. Reads two bytes beyond the pixels, which are in the margin.
__m256i warped_samples(const WarpedSample& first, __m256i x, __m256i y) {
  const __m256i at = _mm256_add_epi32(
      _mm256_mullo_epi32(_mm256_srai_epi32(y, kFixedShift), _mm256_set1_epi32(static_cast<int>(first.stride))),
      _mm256_srai_epi32(x, kFixedShift));
  // A pixel and its right neighbour, each in 16 bits.
  const __m256i spread = _mm256_setr_epi8(0, -1, 1, -1, 4, -1, 5, -1, 8, -1, 9, -1, 12, -1, 13, -1,  //
                                          0, -1, 1, -1, 4, -1, 5, -1, 8, -1, 9, -1, 12, -1, 13, -1);
  const auto pair_at = [&](const std::uint8_t* row) {
    return _mm256_shuffle_epi8(_mm256_i32gather_epi32(reinterpret_cast<const int*>(row), at, 1), spread);
  };
  const __m256i low8 = _mm256_set1_epi32(255);
  const __m256i a = _mm256_and_si256(_mm256_srli_epi32(x, 8), low8),
                b = _mm256_and_si256(_mm256_srli_epi32(y, 8), low8);
  // 256 - a and a, each in 16 bits.
  const __m256i weights = _mm256_sub_epi32(_mm256_or_si256(_mm256_slli_epi32(a, 16), _mm256_set1_epi32(256)), a);
  const __m256i upper = _mm256_madd_epi16(pair_at(first.origin), weights);
  const __m256i lower = _mm256_madd_epi16(pair_at(first.origin + first.stride), weights);
  const __m256i value =
      _mm256_add_epi32(_mm256_slli_epi32(upper, 8), _mm256_mullo_epi32(_mm256_sub_epi32(lower, upper), b));
  return _mm256_sub_epi32(_mm256_srai_epi32(value, 11), _mm256_set1_epi32(kSampleCentre));
}

// The row of a warped window whose first sample is at x, y.
Lanes warped_row(const WarpedSample& first, int x, int y) {
  const __m256i numbers = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  const auto along = [&](int from, int step) {
    return _mm256_add_epi32(_mm256_set1_epi32(from), _mm256_mullo_epi32(numbers, _mm256_set1_epi32(step)));
  };
  const __m256i left = warped_samples(first, along(x, first.x_u), along(y, first.y_u));
  const __m256i right = warped_samples(first, along(x + 8 * first.x_u, first.x_u), along(y + 8 * first.y_u, first.y_u));
  return {_mm256_permute4x64_epi64(_mm256_packs_epi32(left, right), 0xd8)};
}

}  // namespace
}  // namespace coslam
