// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/counters.h"

namespace coslam {

std::string_view name_of(Rejection reason) {
  constexpr std::array<std::string_view, kRejectionCount> kNames = {
      "malformed", "not_finite",   "out_of_range",      "too_many",       "size_mismatch", "ids_not_ascending",
      "bad_id",    "bad_rotation", "bad_text",          "wrong_protocol", "unknown_agent", "wrong_run",
      "duplicate", "overflow",     "missing_reference", "unauthentic",    "replayed"};
  return kNames[static_cast<std::size_t>(reason)];
}

std::uint64_t RejectionCounts::total() const {
  std::uint64_t total = 0;
  for (const auto& count : counts_) total += count.load(std::memory_order_relaxed);
  return total;
}

}  // namespace coslam
