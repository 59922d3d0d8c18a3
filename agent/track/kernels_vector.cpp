// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/kernels.h"

#if defined(__AVX2__)
#include "agent/track/lanes_avx2.h"
#define COSLAM_HAS_LANES
#elif defined(__aarch64__)
#include "agent/track/lanes_neon.h"
#define COSLAM_HAS_LANES
#endif

// The one source that is compiled for a processor's vector unit: AVX2 or NEON. Nothing in it may be a template or
// inline function that other sources have too: the linker might take this one for all.
namespace coslam {
#ifdef COSLAM_HAS_LANES
namespace {

// Rows of 16 interpolated samples, from above to below.
class Rows {
 public:
  Rows(const FirstSample& first, std::ptrdiff_t column)
      : next_(first.pixel + column), stride_(first.stride), blend_(first), left_(next_), right_(next_ + 1) {}
  Lanes next() {
    next_ += stride_;
    const Pixels left(next_), right(next_ + 1);
    const Lanes out = blend_.samples(left_, right_, left, right);
    left_ = left;
    right_ = right;
    return out;
  }

 private:
  const std::uint8_t* next_;
  std::ptrdiff_t stride_;
  Blend blend_;
  Pixels left_, right_;  // the row of pixels above the next samples
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
    const Lanes g = shifted_down<kTemplateShift>(load(row));
    const Lanes x = shifted_down<kTemplateShift + 1>(load(row + 1) - load(row - 1));
    const Lanes y = shifted_down<kTemplateShift + 1>(load(row + kTemplateCols) - load(row - kTemplateCols));
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
    const Lanes s = rows.next();
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
    const Lanes s = rows.next(), small = shifted_down<kTemplateShift>(s);
    total.add(s);
    with_grey.add(s, load(grey + i));
    small_total.add(small);
    small_squares.add(small, small);
  }
  return {total.get(), with_grey.get(), small_total.get(), small_squares.get()};
}

// Twice the columns from the middle. (s * k + 8) >> 4 is the rounded product with k << 11.
alignas(32) constexpr std::int16_t kColumns[kWindowSide] = {
    -30720, -26624, -22528, -18432, -14336, -10240, -6144, -2048, 2048, 6144, 10240, 14336, 18432, 22528, 26624, 30720};

WarpedSums warped(const WarpedSample& first, const std::int16_t* grey, const std::int16_t* dx, const std::int16_t* dy) {
  const Lanes columns = load(kColumns);
  Sum total, small_total, small_squares, with_grey, with_dx, with_dy, column_dx, row_dx, column_dy, row_dy;
  int x = first.x, y = first.y;
  for (int r = 0; r < kWindowSide; ++r, x += first.x_v, y += first.y_v) {
    const Lanes s = warped_row(first, x, y);
    const Lanes small = shifted_down<kTemplateShift>(s);
    const Lanes g = load(grey + r * kWindowSide), gx = load(dx + r * kWindowSide), gy = load(dy + r * kWindowSide);
    const Lanes by_column = rounded_product(s, columns);
    const Lanes by_row = rounded_product(s, same(static_cast<std::int16_t>((2 * r - (kWindowSide - 1)) * 2048)));
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

constexpr Kernels kKernels{cut, step, correlate, warped};

}  // namespace

const Kernels* vector_kernels() { return has_lanes() ? &kKernels : nullptr; }

#else

const Kernels* vector_kernels() { return nullptr; }

#endif
}  // namespace coslam
