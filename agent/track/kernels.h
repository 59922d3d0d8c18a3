// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "agent/track/samples.h"

// The inner loops of the tracker. All in integers, so that each build of them, for whichever vector unit, gives the
// same bits. Sums are over the samples of a window; `small` ones are those in template units, since squares of the
// others do not fit.
namespace coslam {

// The whole pixel and the bilinear weights of the first sample of a window; the others share its fractions.
struct FirstSample {
  const std::uint8_t* pixel = nullptr;
  std::ptrdiff_t stride = 0;
  std::uint16_t w00 = 0, w01 = 0, w10 = 0, w11 = 0;
};

constexpr int kFixedShift = 16;
// Sampling grid of a window that is turned and scaled: coordinates kFixedShift bits below a pixel, from `origin`.
struct WarpedSample {
  const std::uint8_t* origin = nullptr;
  std::ptrdiff_t stride = 0;
  int x = 0, y = 0;      // first sample
  int x_u = 0, y_u = 0;  // step from one sample to the next in a row
  int x_v = 0, y_v = 0;  // step from one row to the next
};

struct TemplateSums {
  int grey = 0, dx = 0, dy = 0;
  int grey_grey = 0, dx_dx = 0, dy_dy = 0, dx_dy = 0, dx_grey = 0, dy_grey = 0;
};
struct StepSums {
  int total = 0, dx = 0, dy = 0, grey = 0;
};
struct CorrelationSums {
  int total = 0, grey = 0, small_total = 0, small_squares = 0;
};
struct WarpedSums {
  int total = 0, small_total = 0, small_squares = 0;
  int grey = 0, dx = 0, dy = 0;
  // Each sample times its column, or row, from the middle of the window, in eighths.
  int column_dx = 0, row_dx = 0, column_dy = 0, row_dy = 0;
};

constexpr int kTemplateCols = 24;  // a pixel more on either side than the window, and up to whole vectors
constexpr int kTemplateRows = kWindowSide + 2;

struct Kernels {  // templates: kWindowArea values each
  // Grey values and central differences. `first`: a pixel up and left of the window's first sample.
  TemplateSums (*cut)(const FirstSample& first, std::int16_t* grey, std::int16_t* dx, std::int16_t* dy);
  // Products of a window with a template.
  StepSums (*step)(const FirstSample& first, const std::int16_t* grey, const std::int16_t* dx, const std::int16_t* dy);
  CorrelationSums (*correlate)(const FirstSample& first, const std::int16_t* grey);
  WarpedSums (*warped)(const WarpedSample& first, const std::int16_t* grey, const std::int16_t* dx,
                       const std::int16_t* dy);
};

const Kernels& portable_kernels();
// The kernels by AVX2 or NEON; null where this processor has neither.
const Kernels* vector_kernels();
// The best that this processor can do.
const Kernels& kernels();
// Has kernels() give these, for comparisons: before anything is tracked.
void use_kernels(const Kernels& chosen);

}  // namespace coslam
