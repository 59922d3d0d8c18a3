// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/kernels.h"

#if defined(__AVX2__)
#include <immintrin.h>
#endif

// The one source that is compiled for AVX2. Nothing in it may be a template or inline function that other sources have
// too: the linker might take this one for all.
namespace coslam {
#if defined(__AVX2__)
namespace {

__m256i load(const std::int16_t* p) { return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p)); }
void store(std::int16_t* p, __m256i v) { _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), v); }

// 16 pixels in lanes of 16 bits.
__m256i pixels(const std::uint8_t* p) {
  return _mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
}

// Adds up products.
class Sum {
 public:
  void add(__m256i a, __m256i b) { lanes_ = _mm256_add_epi32(lanes_, _mm256_madd_epi16(a, b)); }
  void add(__m256i a) { add(a, _mm256_set1_epi16(1)); }
  int get() const {
    __m128i s = _mm_add_epi32(_mm256_castsi256_si128(lanes_), _mm256_extracti128_si256(lanes_, 1));
    s = _mm_add_epi32(s, _mm_shuffle_epi32(s, 0x4e));
    s = _mm_add_epi32(s, _mm_shuffle_epi32(s, 0xb1));
    return _mm_cvtsi128_si32(s);
  }

 private:
  __m256i lanes_ = _mm256_setzero_si256();
};

// Rows of 16 interpolated samples, from above to below.
class Rows {
 public:
  Rows(const FirstSample& first, std::ptrdiff_t column)
      : next_(first.pixel + column),
        stride_(first.stride),
        w00_(_mm256_set1_epi16(static_cast<short>(first.w00))),
        w01_(_mm256_set1_epi16(static_cast<short>(first.w01))),
        w10_(_mm256_set1_epi16(static_cast<short>(first.w10))),
        w11_(_mm256_set1_epi16(static_cast<short>(first.w11))) {
    advance();
  }
  __m256i next() {
    const __m256i upper = _mm256_add_epi16(_mm256_mullo_epi16(left_, w00_), _mm256_mullo_epi16(right_, w01_));
    advance();
    const __m256i lower = _mm256_add_epi16(_mm256_mullo_epi16(left_, w10_), _mm256_mullo_epi16(right_, w11_));
    return _mm256_sub_epi16(_mm256_srli_epi16(_mm256_add_epi16(upper, lower), kWeightShift),
                            _mm256_set1_epi16(kSampleCentre));
  }

 private:
  void advance() {
    left_ = pixels(next_);
    right_ = pixels(next_ + 1);
    next_ += stride_;
  }

  const std::uint8_t* next_;
  std::ptrdiff_t stride_;
  __m256i w00_, w01_, w10_, w11_;
  __m256i left_{}, right_{};  // the row of pixels above the next samples
};

TemplateSums cut(const FirstSample& first, std::int16_t* grey_out, std::int16_t* dx_out, std::int16_t* dy_out) {
  alignas(32) std::int16_t samples[kTemplateCols * kTemplateRows];
  Rows first_columns(first, 0), last_columns(first, 8);
  for (int r = 0; r < kTemplateRows; ++r) {
    store(samples + r * kTemplateCols, first_columns.next());
    store(samples + r * kTemplateCols + 8, last_columns.next());
  }
  Sum grey, dx, dy, grey_grey, dx_dx, dy_dy, dx_dy, dx_grey, dy_grey;
  for (int r = 0; r < kWindowSide; ++r) {
    const std::int16_t* row = samples + (r + 1) * kTemplateCols + 1;
    const __m256i g = _mm256_srai_epi16(load(row), kTemplateShift);
    const __m256i x = _mm256_srai_epi16(_mm256_sub_epi16(load(row + 1), load(row - 1)), kTemplateShift + 1);
    const __m256i y =
        _mm256_srai_epi16(_mm256_sub_epi16(load(row + kTemplateCols), load(row - kTemplateCols)), kTemplateShift + 1);
    store(grey_out + r * kWindowSide, g);
    store(dx_out + r * kWindowSide, x);
    store(dy_out + r * kWindowSide, y);
    grey.add(g);
    dx.add(x);
    dy.add(y);
    grey_grey.add(g, g);
    dx_dx.add(x, x);
    dy_dy.add(y, y);
    dx_dy.add(x, y);
    dx_grey.add(x, g);
    dy_grey.add(y, g);
  }
  return {grey.get(),  dx.get(),    dy.get(),      grey_grey.get(), dx_dx.get(),
          dy_dy.get(), dx_dy.get(), dx_grey.get(), dy_grey.get()};
}

StepSums step(const FirstSample& first, const std::int16_t* grey, const std::int16_t* dx, const std::int16_t* dy) {
  Rows rows(first, 0);
  Sum total, with_dx, with_dy, with_grey;
  for (int i = 0; i < kWindowArea; i += kWindowSide) {
    const __m256i s = rows.next();
    total.add(s);
    with_dx.add(s, load(dx + i));
    with_dy.add(s, load(dy + i));
    with_grey.add(s, load(grey + i));
  }
  return {total.get(), with_dx.get(), with_dy.get(), with_grey.get()};
}

CorrelationSums correlate(const FirstSample& first, const std::int16_t* grey) {
  Rows rows(first, 0);
  Sum total, with_grey, small_total, small_squares;
  for (int i = 0; i < kWindowArea; i += kWindowSide) {
    const __m256i s = rows.next(), small = _mm256_srai_epi16(s, kTemplateShift);
    total.add(s);
    with_grey.add(s, load(grey + i));
    small_total.add(small);
    small_squares.add(small, small);
  }
  return {total.get(), with_grey.get(), small_total.get(), small_squares.get()};
}

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

WarpedSums warped(const WarpedSample& first, const std::int16_t* grey, const std::int16_t* dx, const std::int16_t* dy) {
  const __m256i numbers = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  const auto along = [&](int from, int step) {
    return _mm256_add_epi32(_mm256_set1_epi32(from), _mm256_mullo_epi32(numbers, _mm256_set1_epi32(step)));
  };
  // (s * k + 8) >> 4 is what mulhrs gives for k << 11.
  const __m256i columns =
      _mm256_slli_epi16(_mm256_setr_epi16(-15, -13, -11, -9, -7, -5, -3, -1, 1, 3, 5, 7, 9, 11, 13, 15), 11);
  Sum total, small_total, small_squares, with_grey, with_dx, with_dy, column_dx, row_dx, column_dy, row_dy;
  int x = first.x, y = first.y;
  for (int r = 0; r < kWindowSide; ++r, x += first.x_v, y += first.y_v) {
    const __m256i left = warped_samples(first, along(x, first.x_u), along(y, first.y_u));
    const __m256i right =
        warped_samples(first, along(x + 8 * first.x_u, first.x_u), along(y + 8 * first.y_u, first.y_u));
    const __m256i s = _mm256_permute4x64_epi64(_mm256_packs_epi32(left, right), 0xd8);
    const __m256i small = _mm256_srai_epi16(s, kTemplateShift);
    const __m256i g = load(grey + r * kWindowSide), gx = load(dx + r * kWindowSide), gy = load(dy + r * kWindowSide);
    const __m256i by_column = _mm256_mulhrs_epi16(s, columns);
    const __m256i by_row =
        _mm256_mulhrs_epi16(s, _mm256_set1_epi16(static_cast<short>((2 * r - (kWindowSide - 1)) * 2048)));
    total.add(s);
    small_total.add(small);
    small_squares.add(small, small);
    with_grey.add(s, g);
    with_dx.add(s, gx);
    with_dy.add(s, gy);
    column_dx.add(by_column, gx);
    row_dx.add(by_row, gx);
    column_dy.add(by_column, gy);
    row_dy.add(by_row, gy);
  }
  return {total.get(),   small_total.get(), small_squares.get(), with_grey.get(), with_dx.get(),
          with_dy.get(), column_dx.get(),   row_dx.get(),        column_dy.get(), row_dy.get()};
}

constexpr Kernels kAvx2{cut, step, correlate, warped};

}  // namespace

const Kernels* avx2_kernels() { return __builtin_cpu_supports("avx2") != 0 ? &kAvx2 : nullptr; }

#else

const Kernels* avx2_kernels() { return nullptr; }

#endif
}  // namespace coslam
