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
  job->config.after_iteration = [=, percent_told = std::make_shared<int>(0)](int done) {
    *percent_told = std::max(*percent_told, from_percent + (to_percent - from_percent) * std::min(done, all) / all);
    tell(*percent_told);
  };
}

}  // namespace

PathErrors adjust_whole(BundleEdit& edit, MapId map_id, const BundleAdjustmentConfig& config,
                        std::optional<SetId> adjusted_until, const TellProgress& tell) {
  constexpr int kMostOutlines = 4;  // while a lens is on its way
  for (int round = 0; !adjusted_until && round < kMostOutlines; ++round) {
    auto job = plan_refine(edit.map(), map_id, RefineExtent::kOutline, config);
    if (!job) break;
    tell_of(&*job, kOutlineShare_percent * round / kMostOutlines, kOutlineShare_percent * (round + 1) / kMostOutlines,
            tell);
    if (apply_refine(edit, *job, solve_refine(*job)).lens_step2 < kOnItsWay2) break;
  }
  auto job = adjusted_until ? plan_refine_since(edit.map(), map_id, *adjusted_until, config)
                            : plan_refine(edit.map(), map_id, RefineExtent::kWhole, config);
  PathErrors paths;
  if (job) {
    job->zooms = true;
    tell_of(&*job, adjusted_until ? 0 : kOutlineShare_percent, 100, tell);
    const BundleResult result = solve_refine(*job);
    apply_refine(edit, *job, result);
    if (result.usable) paths = settle_covariances(edit, *job, result);
  }
  if (tell) tell(100);
  return paths;
}

}  // namespace coslam
