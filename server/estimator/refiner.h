// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "common/flow/background_job.h"
#include "server/estimator/adjust/refine.h"

namespace coslam {

// A bundle adjustment that is solved, and the time it took.
struct RefineSolution {
  RefineJob job;
  BundleResult result;
  std::chrono::steady_clock::duration took{};
};

// One bundle adjustment at a time, beside the thread of the map: a job on a snapshot goes in, its solution comes out.
// Of the thread that starts and takes.
class Refiner {
 public:
  // Lock-step: a solution is taken so many frame sets after its plan, no sooner or later, so that the machine's speed
  // does not show in the result.
  static constexpr std::uint32_t kDueSets = 3;

  // threaded: in a thread of its own; else in the caller's, when the solution is taken.
  explicit Refiner(bool threaded);

  // From start() until the solution is taken.
  bool busy() const { return beside_ ? beside_->busy() : inline_job_.has_value(); }
  // planned_at: the frame set after which the job was cut. Not while busy.
  void start(RefineJob job, SetId planned_at);

  // The solution, if it is there; wait: as soon as it is. Empty when nothing was started.
  std::optional<RefineSolution> take(bool wait);
  // What belongs into the map before frame set `now`: in lock-step the solution that is due, waited for; live what
  // there is.
  std::optional<RefineSolution> take_due(SetId now, bool lockstep);

 private:
  // A map that follows its cameras late is worth less than one that is adjusted late.
  std::optional<BackgroundJob<RefineSolution>> beside_;
  std::optional<RefineJob> inline_job_;
  SetId planned_at_;
};

}  // namespace coslam
