// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/bundle_adjustment.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "server/estimator/adjust/lens.h"

namespace coslam {

BundleAdjustmentReport BundleAdjustment::run(BundleEdit& edit, Workers& workers) {
  if (!solved_) return {};
  const auto& [job, result] = *solved_;
  const BundleAdjustmentReport taken{.taken = true,
                                     .usable = result.usable,
                                     .extent = job.extent,
                                     .map = job.map,
                                     .report = apply_refine(edit, job, result, workers)};
  solved_.reset();
  return taken;
}

namespace {

// An outline is solved in about a fifth of the time of the whole.
constexpr int kOutlineShare_percent = 20;

// A job that is solved in two steps, as with zooms, begins to count anew: what was told stands.
void tell_of(RefineJob* job, int from_percent, int to_percent, const TellProgress& tell) {
  if (!tell) return;
  const int all = std::max(1, job->config.max_iterations);
  job->config.after_iteration = [=, told = std::make_shared<int>(0)](int done) {
    *told = std::max(*told, from_percent + (to_percent - from_percent) * std::min(done, all) / all);
    tell(*told);
  };
}

}  // namespace

PathErrors adjust_whole(BundleEdit& edit, MapId of, const BundleAdjustmentConfig& config, std::optional<SetId> since,
                        const TellProgress& tell) {
  constexpr int kMostOutlines = 4;  // while a lens is on its way
  for (int round = 0; !since && round < kMostOutlines; ++round) {
    auto job = plan_refine(edit.map(), of, RefineExtent::kOutline, config);
    if (!job) break;
    tell_of(&*job, kOutlineShare_percent * round / kMostOutlines, kOutlineShare_percent * (round + 1) / kMostOutlines,
            tell);
    if (apply_refine(edit, *job, solve_refine(*job)).lens_step2 < kOnItsWay2) break;
  }
  auto job = since ? plan_refine_since(edit.map(), of, *since, config)
                   : plan_refine(edit.map(), of, RefineExtent::kWhole, config);
  PathErrors paths;
  if (job) {
    job->zooms = true;
    tell_of(&*job, since ? 0 : kOutlineShare_percent, 100, tell);
    const BundleResult result = solve_refine(*job);
    apply_refine(edit, *job, result);
    if (result.usable) paths = settle_covariances(edit, *job, result);
  }
  if (tell) tell(100);
  return paths;
}

}  // namespace coslam
