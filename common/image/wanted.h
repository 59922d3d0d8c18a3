// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace coslam {

// The channels of an image file that are wanted.
enum class Wanted { kGrey, kUnchanged };

constexpr int kMostImageSide = 1 << 15;  // pixels

}  // namespace coslam
