// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/flow/latest_slot.h"
#include "common/model/moving_state.h"
#include "common/wire/codec.h"
#include "common/wire/loop.h"
#include "common/wire/participant.h"

namespace coslam::test {

// A program that only wants to know what moves.
class Planner {
 public:
  explicit Planner(const WireConfig& config)
      : participant_(config, "planner"), loop_(participant_, "planner", std::chrono::milliseconds(20), [] {}) {
    loop_.read<idl::MovingState>([this](const idl::MovingState& m, const Sample&) {
      if (auto state = decode(m)) newest_.put(*state);
    });
    loop_.start();
  }
  // What was heard since the last call.
  std::optional<MovingState> newest() { return newest_.try_take(); }

 private:
  LatestSlot<MovingState> newest_;
  Participant participant_;
  Loop loop_;  // last: stops first
};

}  // namespace coslam::test
