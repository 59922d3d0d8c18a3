// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/scale_kernels.h"

#ifdef __AVX2__
#include "agent/track/scale_loops.h"
#endif

namespace coslam {

#ifdef __AVX2__

namespace {
struct Avx2;
constexpr ScaleKernels kKernels = ScaleLoops<Avx2>::kernels();
}  // namespace

const ScaleKernels* avx2_scale_kernels() { return __builtin_cpu_supports("avx2") != 0 ? &kKernels : nullptr; }

#else

const ScaleKernels* avx2_scale_kernels() { return nullptr; }

#endif

}  // namespace coslam
