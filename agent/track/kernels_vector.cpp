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

// Calls row(i) for the first value of each row of a window, four rows a turn.
template <class Row>
[[gnu::always_inline]] inline void each_row(Row&& row) {
  for (int i = 0; i < kWindowArea; i += 4 * kWindowSide) {
    row(i);
    row(i + kWindowSide);
    row(i + 2 * kWindowSide);
    row(i + 3 * kWindowSide);
  }
}

// Rows of interpolated samples, from above to below; Row: Pixels or WidePixels.
template <class Row>
class Rows {
 public:
  explicit Rows(const FirstSample& first)
      : next_(first.pixel), stride_(first.stride), blend_(first), upper_(first.pixel) {}
  auto next() {
    next_ += stride_;
    const Row lower(next_);
    const auto out = blend_.between(upper_, lower);
    upper_ = lower;
    return out;
  }

 private:
  const std::uint8_t* next_;
  std::ptrdiff_t stride_;
  Blend blend_;
  Row upper_;
};

TemplateSums cut(const FirstSample& first, std::int16_t* grey_out, std::int16_t* dx_out, std::int16_t* dy_out) {
  if (!blends(first)) return portable_kernels().cut(first, grey_out, dx_out, dy_out);
  Rows<WidePixels> rows(first);
  Lanes above = rows.next().middle;
  WideLanes here = rows.next();
  Sum grey, dx, dy, grey_grey, dx_dx, dy_dy, dx_dy, dx_grey, dy_grey;
  each_row([&](int i) __attribute__((always_inline)) {
    const WideLanes below = rows.next();
    const Lanes g = shifted_down<kTemplateShift>(here.middle);
    const Lanes x = shifted_down<kTemplateShift + 1>(here.after - here.before);
    const Lanes y = shifted_down<kTemplateShift + 1>(below.middle - above);
    above = here.middle;
    here = below;
    store(grey_out + i, g);
    store(dx_out + i, x);
    store(dy_out + i, y);
    grey.add(g);
    dx.add(x);
    dy.add(y);
    grey_grey.add(g, g);
    dx_dx.add(x, x);
    dy_dy.add(y, y);
    dx_dy.add(x, y);
    dx_grey.add(x, g);
    dy_grey.add(y, g);
  });
  return {grey.get(),  dx.get(),    dy.get(),      grey_grey.get(), dx_dx.get(),
          dy_dy.get(), dx_dy.get(), dx_grey.get(), dy_grey.get()};
}

StepSums step(const FirstSample& first, const std::int16_t* grey, const std::int16_t* dx, const std::int16_t* dy) {
  if (!blends(first)) return portable_kernels().step(first, grey, dx, dy);
  Rows<Pixels> rows(first);
  Sum total, with_dx, with_dy, with_grey;
  each_row([&](int i) __attribute__((always_inline)) {
    const Lanes s = rows.next();
    total.add(s);
    with_dx.add(s, load(dx + i));
    with_dy.add(s, load(dy + i));
    with_grey.add(s, load(grey + i));
  });
  return {total.get(), with_dx.get(), with_dy.get(), with_grey.get()};
}

CorrelationSums correlate(const FirstSample& first, const std::int16_t* grey) {
  if (!blends(first)) return portable_kernels().correlate(first, grey);
  Rows<Pixels> rows(first);
  Sum total, with_grey, small_total, small_squares;
  each_row([&](int i) __attribute__((always_inline)) {
    const Lanes s = rows.next(), small = shifted_down<kTemplateShift>(s);
    total.add(s);
    with_grey.add(s, load(grey + i));
    small_total.add(small);
    small_squares.add(small, small);
  });
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
