// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arm_neon.h>

#include "agent/track/kernels.h"

// Lanes of kernels_vector.cpp by NEON, which every arm64 processor has. Everything is of that one file.
namespace coslam {
namespace {

constexpr bool has_lanes() { return true; }

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
    left_ = vmlal_high_s16(vmlal_s16(left_, vget_low_s16(a.left), vget_low_s16(b.left)), a.left, b.left);
    right_ = vmlal_high_s16(vmlal_s16(right_, vget_low_s16(a.right), vget_low_s16(b.right)), a.right, b.right);
  }
  void add(Lanes a) {
    left_ = vpadalq_s16(left_, a.left);
    right_ = vpadalq_s16(right_, a.right);
  }
  int get() const { return vaddvq_s32(vaddq_s32(left_, right_)); }

 private:
  int32x4_t left_ = vdupq_n_s32(0), right_ = vdupq_n_s32(0);
};

// A row of 16 pixels.
struct Pixels {
  explicit Pixels(const std::uint8_t* p) {
    const uint8x16_t all = vld1q_u8(p);
    left = vmovl_u8(vget_low_u8(all));
    right = vmovl_high_u8(all);
  }
  uint16x8_t left, right;
};

// Interpolates between rows of pixels and the same one pixel to the right.
class Blend {
 public:
  explicit Blend(const FirstSample& first) : weights_{first.w00, first.w01, first.w10, first.w11} {}
  Lanes samples(Pixels upper, Pixels upper_right, Pixels lower, Pixels lower_right) const {
    return {centred(upper.left, upper_right.left, lower.left, lower_right.left),
            centred(upper.right, upper_right.right, lower.right, lower_right.right)};
  }

 private:
  int16x8_t centred(uint16x8_t p00, uint16x8_t p01, uint16x8_t p10, uint16x8_t p11) const {
    uint16x8_t sum = vmulq_lane_u16(p00, weights_, 0);
    sum = vmlaq_lane_u16(sum, p01, weights_, 1);
    sum = vmlaq_lane_u16(sum, p10, weights_, 2);
    sum = vmlaq_lane_u16(sum, p11, weights_, 3);
    return vsubq_s16(vreinterpretq_s16_u16(vshrq_n_u16(sum, kWeightShift)), vdupq_n_s16(kSampleCentre));
  }

  uint16x4_t weights_;
};

// Coordinates of four samples, kFixedShift bits below a pixel.
struct Coordinates {
  int32x4_t x, y;
};

// Pixels and their right neighbours, at the coordinates of eight samples.
struct Neighbours {
  uint8x8_t here, right;
};

// Sample by sample: NEON gathers nothing.
[[gnu::always_inline]] inline Neighbours gather(const std::uint8_t* origin, int32x4_t at_first, int32x4_t at_last) {
  const auto pair = [origin](int at) { return *reinterpret_cast<const std::uint16_t*>(origin + at); };
  uint16x8_t pairs = vdupq_n_u16(0);
  pairs = vsetq_lane_u16(pair(vgetq_lane_s32(at_first, 0)), pairs, 0);
  pairs = vsetq_lane_u16(pair(vgetq_lane_s32(at_first, 1)), pairs, 1);
  pairs = vsetq_lane_u16(pair(vgetq_lane_s32(at_first, 2)), pairs, 2);
  pairs = vsetq_lane_u16(pair(vgetq_lane_s32(at_first, 3)), pairs, 3);
  pairs = vsetq_lane_u16(pair(vgetq_lane_s32(at_last, 0)), pairs, 4);
  pairs = vsetq_lane_u16(pair(vgetq_lane_s32(at_last, 1)), pairs, 5);
  pairs = vsetq_lane_u16(pair(vgetq_lane_s32(at_last, 2)), pairs, 6);
  pairs = vsetq_lane_u16(pair(vgetq_lane_s32(at_last, 3)), pairs, 7);
  return {vmovn_u16(pairs), vshrn_n_u16(pairs, 8)};
}

// Their fractions in 8 bits.
uint8x8_t fractions(int32x4_t first, int32x4_t last) {
  return vmovn_u16(
      vcombine_u16(vshrn_n_u32(vreinterpretq_u32_s32(first), 8), vshrn_n_u32(vreinterpretq_u32_s32(last), 8)));
}

// 256 * here + (right - here) * a, in 16 bits: fits, and what overflows on the way does not matter.
uint16x8_t between(const Neighbours& p, uint8x8_t a) {
  return vmlsl_u8(vmlal_u8(vshll_n_u8(p.here, 8), p.right, a), p.here, a);
}

int16x4_t between_rows(uint16x4_t upper, uint16x4_t lower, uint16x4_t b) {
  const uint32x4_t value = vmlsl_u16(vmlal_u16(vshll_n_u16(upper, 8), lower, b), upper, b);
  return vreinterpret_s16_u16(vshrn_n_u32(value, 11));
}

// Eight samples at these coordinates.
[[gnu::always_inline]] inline int16x8_t warped_samples(const WarpedSample& first, const Coordinates& c,
                                                       const Coordinates& d) {
  const auto offsets = [&](const Coordinates& k) {
    return vmlaq_n_s32(vshrq_n_s32(k.x, kFixedShift), vshrq_n_s32(k.y, kFixedShift), static_cast<int>(first.stride));
  };
  const int32x4_t at_first = offsets(c), at_last = offsets(d);
  const uint8x8_t a = fractions(c.x, d.x);
  const uint16x8_t b = vmovl_u8(fractions(c.y, d.y));
  const uint16x8_t upper = between(gather(first.origin, at_first, at_last), a);
  const uint16x8_t lower = between(gather(first.origin + first.stride, at_first, at_last), a);
  const int16x8_t value = vcombine_s16(between_rows(vget_low_u16(upper), vget_low_u16(lower), vget_low_u16(b)),
                                       between_rows(vget_high_u16(upper), vget_high_u16(lower), vget_high_u16(b)));
  return vsubq_s16(value, vdupq_n_s16(kSampleCentre));
}

// The row of a warped window whose first sample is at x, y.
Lanes warped_row(const WarpedSample& first, int x, int y) {
  constexpr int32x4_t kNumbers = {0, 1, 2, 3};
  const auto next_four = [&](const Coordinates& c) {
    return Coordinates{vaddq_s32(c.x, vdupq_n_s32(4 * first.x_u)), vaddq_s32(c.y, vdupq_n_s32(4 * first.y_u))};
  };
  const Coordinates a{vmlaq_n_s32(vdupq_n_s32(x), kNumbers, first.x_u),
                      vmlaq_n_s32(vdupq_n_s32(y), kNumbers, first.y_u)};
  const Coordinates b = next_four(a), c = next_four(b), d = next_four(c);
  return {warped_samples(first, a, b), warped_samples(first, c, d)};
}

}  // namespace
}  // namespace coslam
