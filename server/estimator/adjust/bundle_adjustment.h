// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/workers.h"
#include "server/estimator/adjust/apply_refine.h"
#include "server/estimator/adjust/certainty.h"
#include "server/estimator/adjust/refine.h"

// Bundle adjustment beside the frame sets: planned at one (key_frames.h), handed out as a job, taken in at a later one.
// At most one is on its way.
namespace coslam {

struct BundleAdjustmentReport {
  bool taken = false;  // there was a solution
  bool usable = false;
  RefineExtent extent = RefineExtent::kWindow;
  MapId map;
  RefineReport report;

  void count(auto&& add) const {
    add("refine_applied", report.applied);
    add("refine_outliers", report.outliers);
    add("refine_observations", taken ? report.observations : 0);
    add("lenses_corrected", report.lenses);
  }
};

// Takes the solution of the last job in, before anything else looks at the map.
class BundleAdjustment {
 public:
  static constexpr std::string_view kName = "bundle_adjustment";
  using Config = BundleAdjustmentConfig;
  explicit BundleAdjustment(const BundleAdjustmentConfig& of) : config(of) {}
  BundleAdjustmentConfig config;

  void give(RefineJob job, BundleResult result) { solved_.emplace(std::move(job), std::move(result)); }
  BundleAdjustmentReport run(BundleEdit& edit, Workers& workers);

 private:
  std::optional<std::pair<RefineJob, BundleResult>> solved_;
};

// How far it is, percent.
using TellProgress = std::function<void(int percent)>;

// The last word: all key frames of a map, or those after `since`, before which it was adjusted as a whole already. How
// uncertain the paths are in the end.
PathErrors adjust_whole(BundleEdit& edit, MapId of, const BundleAdjustmentConfig& config,
                        std::optional<SetId> since = std::nullopt, const TellProgress& tell = {});

}  // namespace coslam
