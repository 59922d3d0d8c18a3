// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/base/replay_rate.h"

#include "common/base/error.h"
#include "common/base/text.h"

namespace coslam {

double parse_replay_rate(const std::string& text) {
  if (text == "max") return 0;
  const auto rate = parse_double(text);
  if (!rate || !(*rate > 0 && *rate <= 1000)) {
    throw UsageError("--rate takes a positive number or max, not '" + text + "'");
  }
  return *rate;
}

}  // namespace coslam
