// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/link/speakers.h"

#include <algorithm>

namespace coslam {

Speakers::Process Speakers::process_of(const WriterId& writer) {
  Process process{};
  std::copy_n(writer.guid.begin(), process.size(), process.begin());
  return process;
}

bool Speakers::may_say(RunId run, const WriterId& writer, bool is_hello) {
  if (const auto known = run_of(writer)) return *known == run;
  if (std::ranges::any_of(run_of_, [run](const auto& r) { return r.second == run; })) return false;
  if (is_hello) run_of_.emplace(process_of(writer), run);
  return true;
}

std::optional<RunId> Speakers::run_of(const WriterId& writer) const {
  const auto known = run_of_.find(process_of(writer));
  return known == run_of_.end() ? std::nullopt : std::optional(known->second);
}

}  // namespace coslam
