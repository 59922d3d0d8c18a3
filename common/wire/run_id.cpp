// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/run_id.h"

#include <random>

namespace coslam {

RunId draw_run_id() {
  std::random_device device;
  const std::uint64_t high = device(), low = device();
  return RunId((high << 32U | low) | 1U);  // 0 is none
}

}  // namespace coslam
