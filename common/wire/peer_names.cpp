// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/peer_names.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "common/base/log.h"
#include "common/base/words.h"

namespace coslam {

void await_names(std::vector<std::string>* peers, const std::function<bool()>& wait,
                 const std::function<std::vector<std::string>(const std::vector<std::string>&)>& unknown) {
  std::vector<std::string> missing = unknown(*peers);
  if (missing.empty()) return;
  const auto named = [&] { return (missing.size() == 1 ? "peer " : "peers ") + joined(missing); };
  log_info("no address is known of the " + named() + " yet: waiting for it");
  while (!missing.empty() && wait()) missing = unknown(*peers);
  if (missing.empty()) return;
  log_warn("no address is known of the " + named() +
           ": going on without, which does where multicast passes; a name has to resolve (`getent hosts NAME`), an "
           "IPv4 address always works");
  std::erase_if(*peers, [&](const std::string& peer) { return std::ranges::count(missing, peer) > 0; });
}

std::function<bool()> while_starting(std::function<bool()> stops) {
  constexpr std::chrono::seconds kMost{10};
  constexpr std::chrono::milliseconds kMoment{250};
  const auto until = std::chrono::steady_clock::now() + kMost;
  return [=, stops = std::move(stops)] {
    std::this_thread::sleep_for(kMoment);
    return !stops() && std::chrono::steady_clock::now() < until;
  };
}

}  // namespace coslam
