// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/scale_kernels.h"

#include "agent/track/scale_loops.h"

namespace coslam {

namespace {
struct Portable;
}  // namespace

const ScaleKernels& portable_scale_kernels() {
  static constexpr ScaleKernels kKernels = ScaleLoops<Portable>::kernels();
  return kKernels;
}

const ScaleKernels& scale_kernels() {
  static const ScaleKernels& best = avx2_scale_kernels() != nullptr ? *avx2_scale_kernels() : portable_scale_kernels();
  return best;
}

}  // namespace coslam
