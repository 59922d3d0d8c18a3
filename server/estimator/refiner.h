// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "common/flow/background_job.h"
#include "server/estimator/adjust/refine.h"

namespace coslam {

// Solution of a bundle adjustment, and the time it took.
struct RefineSolution {
  RefineJob job;
  BundleResult result;
  std::chrono::steady_clock::duration took{};
};

// Runs one bundle adjustment at a time, beside the thread of the map: takes a job on a snapshot, gives its solution.
// All calls are made by one thread.
class Refiner {
 public:
  // Frame sets from the plan to the solution's use in lock-step, no more and no fewer, so that the machine's speed does
  // not show in the result.
  static constexpr std::uint32_t kDueSets = 3;

  // threaded: solves in its own thread; else in the caller's, when the solution is taken.
  explicit Refiner(bool threaded);

  // True from start() until the solution is taken.
  bool busy() const { return beside_ ? beside_->busy() : inline_job_.has_value(); }
  // Starts a job, when not busy; planned_at: the frame set after which the job was cut.
  void start(RefineJob job, SetId planned_at);

  // Returns the solution if it is there; wait: as soon as it is. Empty when nothing was started.
  std::optional<RefineSolution> take(bool wait);
  // Returns the solution that is to be applied before frame set `now`: in lock-step the one that is due, waited for;
  // live whatever is there.
  std::optional<RefineSolution> take_due(SetId now, bool lockstep);

 private:
  // Lets the map's thread go first: a late map is worse than a late adjustment.
  std::optional<BackgroundJob<RefineSolution>> beside_;
  std::optional<RefineJob> inline_job_;
  SetId planned_at_;
};

}  // namespace coslam
