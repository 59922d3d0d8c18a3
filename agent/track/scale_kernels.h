// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace coslam {

constexpr int kMostBlurRadius = 10;

// The inner loops of the scale space, over whole rows. All in integers, so that each build of them gives the same bits.
struct ScaleKernels {
  // out[x]: weighted sum of taps[0 .. 2 radius][x]; weights[k], with 15 bits below the point, is that of the two taps k
  // beside the middle. Rounded after each product; a pair of taps must fit into 16 bits.
  void (*blur)(const std::int16_t* const* taps, const std::int16_t* weights, int radius, int count, std::int16_t* out);
  void (*subtract)(const std::int16_t* a, const std::int16_t* b, int count, std::int16_t* out);
  // found[x]: whether the value at x + 1 of the middle one of nine rows, three of each of three layers, is beyond the
  // threshold and, up or down, not below any of the 26 around it.
  void (*extrema)(const std::int16_t* const* rows, std::int16_t threshold, int count, std::uint8_t* found);
};

const ScaleKernels& portable_scale_kernels();
const ScaleKernels* avx2_scale_kernels();  // null where they are not built, or this processor has no AVX2
// The best that this processor can do.
const ScaleKernels& scale_kernels();

}  // namespace coslam
