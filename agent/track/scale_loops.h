// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "agent/track/scale_kernels.h"

namespace coslam {

// The loops behind ScaleKernels, built for the vector unit that the file which uses them is compiled for. Build: a type
// of that file, so that no other file's build takes their place.
template <class Build>
class ScaleLoops {
 public:
  static constexpr ScaleKernels kernels() { return {blur_any<kMostBlurRadius>, subtract, extrema}; }

 private:
  // a * b, of which b has 15 bits below the point; rounded.
  static std::int16_t weighed(std::int16_t a, std::int16_t b) {
    return static_cast<std::int16_t>(((static_cast<int>(a) * static_cast<int>(b) >> 14) + 1) >> 1);
  }

  // A sum with weights that are one in all.
  template <int kRadius>
  static void blur(const std::int16_t* const* taps, const std::int16_t* weights, int count, std::int16_t* out) {
    std::array<const std::int16_t*, 2 * kRadius + 1> t{};
    std::array<std::int16_t, kRadius + 1> w{};
    std::copy_n(taps, t.size(), t.begin());
    std::copy_n(weights, w.size(), w.begin());
#pragma GCC ivdep
    for (int x = 0; x < count; ++x) {
      std::int16_t sum = weighed(t[kRadius][x], w[0]);
#pragma GCC unroll 10
      for (int k = 1; k <= kRadius; ++k) {
        const auto pair = static_cast<std::int16_t>(t[kRadius - k][x] + t[kRadius + k][x]);
        sum = static_cast<std::int16_t>(sum + weighed(pair, w[k]));
      }
      out[x] = sum;
    }
  }

  template <int kRadius>
  static void blur_any(const std::int16_t* const* taps, const std::int16_t* weights, int radius, int count,
                       std::int16_t* out) {
    if constexpr (kRadius > 0) {
      if (radius == kRadius) {
        blur<kRadius>(taps, weights, count, out);
      } else {
        blur_any<kRadius - 1>(taps, weights, radius, count, out);
      }
    }
  }

  static void subtract(const std::int16_t* a, const std::int16_t* b, int count, std::int16_t* out) {
#pragma GCC ivdep
    for (int x = 0; x < count; ++x) out[x] = static_cast<std::int16_t>(a[x] - b[x]);
  }

  static void extrema(const std::int16_t* const* rows, std::int16_t threshold, int count, std::uint8_t* found) {
    std::array<const std::int16_t*, 9> row{};
    std::copy_n(rows, row.size(), row.begin());
#pragma GCC ivdep
    for (int x = 0; x < count; ++x) {
      std::int16_t high = row[0][x], low = high;
#pragma GCC unroll 9
      for (int r = 0; r < 9; ++r) {
        const std::int16_t a = row[r][x], b = row[r][x + 1], c = row[r][x + 2];
        high = std::max(high, std::max(a, std::max(b, c)));
        low = std::min(low, std::min(a, std::min(b, c)));
      }
      const std::int16_t v = row[4][x + 1];
      const bool top = (v == high) & (v > threshold), bottom = (v == low) & (v < -threshold);
      found[x] = static_cast<std::uint8_t>(top | bottom);
    }
  }
};

}  // namespace coslam
