// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "agent/track/match_limits.h"

namespace coslam {

// Shifts of the whole image that are tried along a side, with a rim of one.
constexpr int kShiftSide = 2 * kShiftRadius + 3;

extern const char* const kMatchSource;  // program/*.cl, one after another
extern const char* const kCudaDialect;  // cuda_dialect.cuh

// Program of all kernels: program/*.cl with the CPU's constants in front. GROUP is for the device to define.
std::string match_program();

}  // namespace coslam
