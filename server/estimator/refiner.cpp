// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/refiner.h"

#include <utility>

#include "common/base/check.h"

namespace coslam {
namespace {

RefineSolution solve(RefineJob job) {
  const auto begin = std::chrono::steady_clock::now();
  BundleResult result = solve_refine(job);
  return {std::move(job), std::move(result), std::chrono::steady_clock::now() - begin};
}

}  // namespace

Refiner::Refiner(bool threaded) {
  if (threaded) beside_.emplace("refine");
}

void Refiner::start(RefineJob job, SetId planned_at) {
  COSLAM_CHECK(!busy(), "one bundle adjustment at a time");
  planned_at_ = planned_at;
  if (beside_) {
    beside_->start([job = std::move(job)]() mutable { return solve(std::move(job)); });
  } else {
    inline_job_ = std::move(job);
  }
}

std::optional<RefineSolution> Refiner::take(bool wait) {
  if (beside_) return beside_->take(wait);
  if (!inline_job_) return std::nullopt;
  return solve(*std::exchange(inline_job_, std::nullopt));
}

std::optional<RefineSolution> Refiner::take_due(SetId now, bool lockstep) {
  if (lockstep && now.value < planned_at_.value + kDueSets) return std::nullopt;
  return take(lockstep);
}

}  // namespace coslam
