// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>

#include "common/wire/loop.h"
#include "common/wire/writers.h"

namespace coslam {

// Ends of the server's link in the domain: participant, writers and readers.
struct ServerEnds {
  using ToAll = Writers<SelectedTypes<goes_to_all, ServerStatus>>;
  using ToRun = Writers<SelectedTypes<goes_to_run>>;

  Participant participant;
  Writer<idl::ServerStatus> status{participant};
  ToAll all{participant};
  std::map<RunId, ToRun> runs;  // ways back: writers in the partition of each run
  Loop loop;                    // last: stops first

  ServerEnds(const WireConfig& config, const char* name, std::shared_ptr<RejectionCounts> rejections,
             std::chrono::milliseconds tick, const std::function<void(ServerEnds&)>& on_tick)
      : participant(config, name, std::move(rejections)),
        loop(participant, "server-link", tick, [this, on_tick] { on_tick(*this); }) {}
};

}  // namespace coslam
