// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/refiner.h"

#include <utility>

#include "common/base/check.h"
#include "common/flow/give_way.h"

namespace coslam {
namespace {

RefineSolution solve(RefineJob job) {
  const auto begin = std::chrono::steady_clock::now();
  BundleResult result = solve_refine(job);
  return {std::move(job), std::move(result), std::chrono::steady_clock::now() - begin};
}

}  // namespace

Refiner::Refiner(bool threaded) {
  if (!threaded) return;
  worker_.emplace("refine", [this](const std::stop_token& stop) {
    give_way();  // a map that follows its cameras late is worth less than one that is adjusted late
    while (!stop.stop_requested()) {
      std::optional<RefineJob> job = jobs_.take();
      if (!job) return;
      solutions_.put(solve(std::move(*job)));
    }
  });
}

Refiner::~Refiner() {
  jobs_.close();
  solutions_.close();
}

void Refiner::start(RefineJob job, SetId planned_at) {
  COSLAM_CHECK(!busy_, "one bundle adjustment at a time");
  busy_ = true;
  planned_at_ = planned_at;
  if (worker_) {
    jobs_.put(std::move(job));
  } else {
    inline_job_ = std::move(job);
  }
}

std::optional<RefineSolution> Refiner::take(bool wait) {
  if (!busy_) return std::nullopt;
  std::optional<RefineSolution> solution;
  if (inline_job_) {
    solution = solve(std::move(*inline_job_));
    inline_job_.reset();
  } else {
    solution = wait ? solutions_.take() : solutions_.try_take();
  }
  busy_ = !solution.has_value();
  return solution;
}

std::optional<RefineSolution> Refiner::take_due(SetId now, bool lockstep) {
  if (lockstep && now.value < planned_at_.value + kDueSets) return std::nullopt;
  return take(lockstep);
}

}  // namespace coslam
