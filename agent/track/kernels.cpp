// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/kernels.h"

#include <array>

namespace coslam {
namespace {

using Values = const std::int16_t*;  // kWindowArea

int dot(Values a, Values b) {
  int sum = 0;
  for (int i = 0; i < kWindowArea; ++i) sum += a[i] * b[i];
  return sum;
}
int dot(const Samples& a, Values b) { return dot(a.data(), b); }

int total(Values a) {
  int sum = 0;
  for (int i = 0; i < kWindowArea; ++i) sum += a[i];
  return sum;
}
int total(const Samples& a) { return total(a.data()); }

Samples small_of(const Samples& samples) {
  Samples small;
  for (std::size_t i = 0; i < kWindowArea; ++i) small[i] = static_cast<std::int16_t>(samples[i] >> kTemplateShift);
  return small;
}

template <int kCols, int kRows>
void sample(const FirstSample& first, std::int16_t* out) {
  const std::uint16_t w00 = first.w00, w01 = first.w01, w10 = first.w10, w11 = first.w11;
  const std::uint8_t* upper = first.pixel;
  for (int r = 0; r < kRows; ++r, upper += first.stride, out += kCols) {
    const std::uint8_t* lower = upper + first.stride;
    for (int c = 0; c < kCols; ++c) {
      const auto sum =
          static_cast<std::uint16_t>(upper[c] * w00 + upper[c + 1] * w01 + lower[c] * w10 + lower[c + 1] * w11);
      out[c] = static_cast<std::int16_t>((sum >> kWeightShift) - kSampleCentre);
    }
  }
}

// Central difference of samples, over two pixels, in template units.
std::int16_t difference(std::int16_t after, std::int16_t before) {
  const auto d = static_cast<std::int16_t>(after - before);  // fits: narrow before the shift, to stay in 16-bit lanes
  return static_cast<std::int16_t>(d >> (kTemplateShift + 1));
}

TemplateSums cut(const FirstSample& first, std::int16_t* grey, std::int16_t* dx, std::int16_t* dy) {
  // Written at once. NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
  alignas(64) std::array<std::int16_t, kTemplateCols * kTemplateRows> samples;
  sample<kTemplateCols, kTemplateRows>(first, samples.data());
  for (int r = 0; r < kWindowSide; ++r) {
    const std::int16_t* row = samples.data() + (r + 1) * kTemplateCols + 1;
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(r) * kWindowSide;
    for (int c = 0; c < kWindowSide; ++c) {
      grey[at + c] = static_cast<std::int16_t>(row[c] >> kTemplateShift);
      dx[at + c] = difference(row[c + 1], row[c - 1]);
      dy[at + c] = difference(row[c + kTemplateCols], row[c - kTemplateCols]);
    }
  }
  return {total(grey), total(dx),   total(dy),     dot(grey, grey), dot(dx, dx),
          dot(dy, dy), dot(dx, dy), dot(dx, grey), dot(dy, grey)};
}

StepSums step(const FirstSample& first, Values grey, Values dx, Values dy) {
  Samples samples;
  sample<kWindowSide, kWindowSide>(first, samples.data());
  return {total(samples), dot(samples, dx), dot(samples, dy), dot(samples, grey)};
}

CorrelationSums correlate(const FirstSample& first, Values grey) {
  Samples samples;
  sample<kWindowSide, kWindowSide>(first, samples.data());
  const Samples small = small_of(samples);
  return {total(samples), dot(samples, grey), total(small), dot(small, small.data())};
}

void sample_warped(const WarpedSample& first, Samples& out) {
  std::int16_t* sample = out.data();
  int x_row = first.x, y_row = first.y;
  for (int r = 0; r < kWindowSide; ++r, x_row += first.x_v, y_row += first.y_v) {
    int x = x_row, y = y_row;
    for (int c = 0; c < kWindowSide; ++c, x += first.x_u, y += first.y_u) {
      const std::uint8_t* p = first.origin + (y >> kFixedShift) * first.stride + (x >> kFixedShift);
      const int a = (x >> 8) & 255, b = (y >> 8) & 255;  // fractions in 8 bits, so the value has 16 below a grey level
      const int upper = (p[0] << 8) + (p[1] - p[0]) * a;
      const int lower = (p[first.stride] << 8) + (p[first.stride + 1] - p[first.stride]) * a;
      *sample++ = static_cast<std::int16_t>((((upper << 8) + (lower - upper) * b) >> 11) - kSampleCentre);
    }
  }
}

Samples times_column(const Samples& samples) {
  Samples out;
  for (int i = 0; i < kWindowArea; ++i) {
    const auto k = static_cast<std::size_t>(i);
    out[k] = static_cast<std::int16_t>((samples[k] * (2 * (i % kWindowSide) - (kWindowSide - 1)) + 8) >> 4);
  }
  return out;
}

Samples times_row(const Samples& samples) {
  Samples out;
  for (int i = 0; i < kWindowArea; ++i) {
    const auto k = static_cast<std::size_t>(i);
    out[k] = static_cast<std::int16_t>((samples[k] * (2 * (i / kWindowSide) - (kWindowSide - 1)) + 8) >> 4);
  }
  return out;
}

WarpedSums warped(const WarpedSample& first, Values grey, Values dx, Values dy) {
  Samples samples;
  sample_warped(first, samples);
  const Samples small = small_of(samples), by_column = times_column(samples), by_row = times_row(samples);
  return {.total = total(samples),
          .small_total = total(small),
          .small_squares = dot(small, small.data()),
          .grey = dot(samples, grey),
          .dx = dot(samples, dx),
          .dy = dot(samples, dy),
          .column_dx = dot(by_column, dx),
          .row_dx = dot(by_row, dx),
          .column_dy = dot(by_column, dy),
          .row_dy = dot(by_row, dy)};
}

const Kernels*& kernels_in_use() {
  static const Kernels* in_use = vector_kernels() != nullptr ? vector_kernels() : &portable_kernels();
  return in_use;
}

}  // namespace

const Kernels& portable_kernels() {
  static constexpr Kernels kPortable{cut, step, correlate, warped};
  return kPortable;
}

const Kernels& kernels() { return *kernels_in_use(); }

void use_kernels(const Kernels& chosen) { kernels_in_use() = &chosen; }

}  // namespace coslam
