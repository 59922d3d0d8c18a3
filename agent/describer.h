// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>

#include "agent/agent.h"
#include "common/flow/background_job.h"

namespace coslam {

// Describes images in a thread of its own, one at a time, so that no frame waits for it.
class Describer {
 public:
  struct Described {
    DescribeEnd end;
    std::chrono::steady_clock::duration took{};
  };

  Describer() : beside_("describe") {}

  bool busy() const { return beside_.busy(); }
  void start(DescribeWork work);
  // Takes the finished description; empty: nothing was begun, or it is not done.
  std::optional<Described> take() { return beside_.take(); }

 private:
  BackgroundJob<Described> beside_;
};

}  // namespace coslam
