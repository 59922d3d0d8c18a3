// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arm_neon.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "agent/track/kernels.h"

// Lanes of kernels_vector.cpp by NEON, which every arm64 processor has. Everything is of that one file.
namespace coslam {
namespace {

constexpr bool has_lanes() { return true; }

// Weights of 8 bits are half the work; a window whose weights are whole pixels has one that needs nine.
bool blends(const FirstSample& first) { return ((first.w00 | first.w01 | first.w10 | first.w11) & kWeightSum) == 0; }

// The 16 samples of a row, 16 bits each.
struct Lanes {
  int16x8_t left, right;
};

Lanes load(const std::int16_t* p) { return {vld1q_s16(p), vld1q_s16(p + 8)}; }
void store(std::int16_t* p, Lanes a) {
  vst1q_s16(p, a.left);
  vst1q_s16(p + 8, a.right);
}
Lanes same(std::int16_t value) { return {vdupq_n_s16(value), vdupq_n_s16(value)}; }
Lanes operator-(Lanes a, Lanes b) { return {vsubq_s16(a.left, b.left), vsubq_s16(a.right, b.right)}; }
template <int kBits>
Lanes shifted_down(Lanes a) {
  return {vshrq_n_s16(a.left, kBits), vshrq_n_s16(a.right, kBits)};
}
// (a * b + 2^14) >> 15
Lanes rounded_product(Lanes a, Lanes b) { return {vqrdmulhq_s16(a.left, b.left), vqrdmulhq_s16(a.right, b.right)}; }

// Adds up products.
class Sum {
 public:
  void add(Lanes a, Lanes b) {
    lanes_ = vmlal_high_s16(vmlal_s16(lanes_, vget_low_s16(a.left), vget_low_s16(b.left)), a.left, b.left);
    lanes_ = vmlal_high_s16(vmlal_s16(lanes_, vget_low_s16(a.right), vget_low_s16(b.right)), a.right, b.right);
  }
  void add(Lanes a) { lanes_ = vpadalq_s16(vpadalq_s16(lanes_, a.left), a.right); }
  int get() const { return vaddvq_s32(lanes_); }

 private:
  int32x4_t lanes_ = vdupq_n_s32(0);
};

// Rows of eight pixels, and the same one pixel to the right. In parts of eight, because GCC copies halves of registers.
struct Eight {
  explicit Eight(const std::uint8_t* p) : here(vld1_u8(p)), right(vld1_u8(p + 1)) {}
  uint8x8_t here, right;
};
struct Pixels {
  explicit Pixels(const std::uint8_t* p) : left(p), right(p + 8) {}
  Eight left, right;
};
struct WidePixels {
  explicit WidePixels(const std::uint8_t* p) : first(p), last(p + 16) {}
  Pixels first;
  Eight last;
};

// A row of samples, one more on either side.
struct WideLanes {
  Lanes before, middle, after;
};

// Interpolates between two rows.
class Blend {
 public:
  explicit Blend(const FirstSample& first)
      : w00_(all(first.w00)), w01_(all(first.w01)), w10_(all(first.w10)), w11_(all(first.w11)) {}

  Lanes between(const Pixels& upper, const Pixels& lower) const {
    return {samples(upper.left, lower.left), samples(upper.right, lower.right)};
  }
  WideLanes between(const WidePixels& upper, const WidePixels& lower) const {
    const Lanes a = between(upper.first, lower.first);
    const int16x8_t last = samples(upper.last, lower.last);
    return {a, from<1>(a, last), from<2>(a, last)};
  }

 private:
  static uint8x8_t all(std::uint16_t weight) { return vdup_n_u8(static_cast<std::uint8_t>(weight)); }
  int16x8_t samples(const Eight& upper, const Eight& lower) const {
    uint16x8_t sum = vmull_u8(upper.here, w00_);
    sum = vmlal_u8(sum, upper.right, w01_);
    sum = vmlal_u8(sum, lower.here, w10_);
    sum = vmlal_u8(sum, lower.right, w11_);
    return vsubq_s16(vreinterpretq_s16_u16(vshrq_n_u16(sum, kWeightShift)), vdupq_n_s16(kSampleCentre));
  }
  template <int kColumn>
  static Lanes from(Lanes a, int16x8_t last) {
    return {vextq_s16(a.left, a.right, kColumn), vextq_s16(a.right, last, kColumn)};
  }

  uint8x8_t w00_, w01_, w10_, w11_;
};

// Pixels below and to the right of the coordinates of 16 samples, and the fractions of those in 8 bits.
struct Corners {
  uint8x16_t p00, p01, p10, p11;
  uint8x16_t a, b;
};

// The bytes above the lowest of 16 coordinates: fractions and whole pixels.
struct Split {
  uint8x16_t fractions, whole;
};
[[gnu::always_inline]] inline Split split(int from, int step) {
  constexpr int32x4_t kNumbers = {0, 1, 2, 3};
  const int32x4_t four = vdupq_n_s32(4 * step);
  const int32x4_t a = vmlaq_n_s32(vdupq_n_s32(from), kNumbers, step), b = vaddq_s32(a, four), c = vaddq_s32(b, four),
                  d = vaddq_s32(c, four);
  const auto bytes = [](int32x4_t low, int32x4_t high) {
    return vreinterpretq_u8_s16(vshrn_high_n_s32(vshrn_n_s32(low, 8), high, 8));
  };
  const uint8x16_t left = bytes(a, b), right = bytes(c, d);
  return {vuzp1q_u8(left, right), vuzp2q_u8(left, right)};
}

constexpr int kTableCols = 32;

// Looks a row up that lies within two rows of pixels: those around it are a table. Reads kTableCols pixels from the
// leftmost on.
[[gnu::always_inline]] inline Corners look_up(const WarpedSample& first, int x, int y, int left, int top) {
  const Split xs = split(x - left * (1 << kFixedShift), first.x_u), ys = split(y - top * (1 << kFixedShift), first.y_u);
  const std::uint8_t* row = first.origin + top * first.stride + left;
  const uint8x16x2_t r0 = vld1q_u8_x2(row), r1 = vld1q_u8_x2(row + first.stride),
                     r2 = vld1q_u8_x2(row + 2 * first.stride);
  const uint8x16x4_t upper = {{r0.val[0], r0.val[1], r1.val[0], r1.val[1]}};
  const uint8x16x4_t lower = {{r1.val[0], r1.val[1], r2.val[0], r2.val[1]}};
  const uint8x16_t at = vmlaq_u8(xs.whole, ys.whole, vdupq_n_u8(kTableCols)), next = vaddq_u8(at, vdupq_n_u8(1));
  return {vqtbl4q_u8(upper, at), vqtbl4q_u8(upper, next), vqtbl4q_u8(lower, at), vqtbl4q_u8(lower, next), xs.fractions,
          ys.fractions};
}

// Fetches any row, sample by sample: NEON gathers nothing.
[[gnu::noinline]] Corners gather(const WarpedSample& first, int x, int y) {
  alignas(16) std::array<std::uint16_t, kWindowSide> upper, lower;  // a pixel and its right neighbour. NOLINT
  const Split xs = split(x, first.x_u), ys = split(y, first.y_u);
  for (std::size_t c = 0; c < kWindowSide; ++c, x += first.x_u, y += first.y_u) {
    const std::uint8_t* at = first.origin + (y >> kFixedShift) * first.stride + (x >> kFixedShift);
    std::memcpy(&upper[c], at, 2);
    std::memcpy(&lower[c], at + first.stride, 2);
  }
  const uint8x16x2_t u = vld2q_u8(reinterpret_cast<const std::uint8_t*>(upper.data()));
  const uint8x16x2_t l = vld2q_u8(reinterpret_cast<const std::uint8_t*>(lower.data()));
  return {u.val[0], u.val[1], l.val[0], l.val[1], xs.fractions, ys.fractions};
}

// Between eight pixels and their right neighbours, in 16 bits: fits, and what overflows on the way does not matter.
uint16x8_t between_columns(uint8x8_t left, uint8x8_t right, uint8x8_t a) {
  return vmlsl_u8(vmlal_u8(vshll_n_u8(left, 8), right, a), left, a);
}

int16x8_t between_rows(uint16x8_t upper, uint16x8_t lower, uint8x8_t b) {
  const uint16x8_t of_lower = vmovl_u8(b), of_upper = vsubq_u16(vdupq_n_u16(256), of_lower);
  const uint32x4_t low =
      vmlal_u16(vmull_u16(vget_low_u16(upper), vget_low_u16(of_upper)), vget_low_u16(lower), vget_low_u16(of_lower));
  const uint32x4_t high = vmlal_high_u16(vmull_high_u16(upper, of_upper), lower, of_lower);
  const uint16x8_t value = vshrn_high_n_u32(vshrn_n_u32(low, 11), high, 11);
  return vsubq_s16(vreinterpretq_s16_u16(value), vdupq_n_s16(kSampleCentre));
}

[[gnu::always_inline]] inline Lanes blended(const Corners& c) {
  const auto eight = [](uint8x8_t p00, uint8x8_t p01, uint8x8_t p10, uint8x8_t p11, uint8x8_t a, uint8x8_t b) {
    return between_rows(between_columns(p00, p01, a), between_columns(p10, p11, a), b);
  };
  return {eight(vget_low_u8(c.p00), vget_low_u8(c.p01), vget_low_u8(c.p10), vget_low_u8(c.p11), vget_low_u8(c.a),
                vget_low_u8(c.b)),
          eight(vget_high_u8(c.p00), vget_high_u8(c.p01), vget_high_u8(c.p10), vget_high_u8(c.p11), vget_high_u8(c.a),
                vget_high_u8(c.b))};
}

// The row of a warped window whose first sample is at x, y.
[[gnu::always_inline]] inline Lanes warped_row(const WarpedSample& first, int x, int y) {
  const int last_x = x + (kWindowSide - 1) * first.x_u, last_y = y + (kWindowSide - 1) * first.y_u;
  const int left = std::min(x, last_x) >> kFixedShift, top = std::min(y, last_y) >> kFixedShift;
  if ((std::max(x, last_x) >> kFixedShift) - left < kTableCols - 1 && (std::max(y, last_y) >> kFixedShift) - top < 2) {
    return blended(look_up(first, x, y, left, top));
  }
  return blended(gather(first, x, y));
}

}  // namespace
}  // namespace coslam
