// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace coslam {

// Sound track of a video, one channel.
struct Sound {
  static constexpr int kRate_hz = 8000;
  double begins_s = 0;  // against the first image
  std::vector<float> samples;
};

}  // namespace coslam
