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

// Bundle adjustment beside the frame sets: planned at one (key_frames.h), handed out as a job, applied at a later one.
// At most one is in flight.
namespace coslam {

struct BundleAdjustmentReport {
  bool taken = false;  // a solution was applied or dropped
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

// Applies the solution of the last job, before any other stage reads the map.
class BundleAdjustment {
 public:
  static constexpr std::string_view kName = "bundle_adjustment";
  using Config = BundleAdjustmentConfig;
  explicit BundleAdjustment(const BundleAdjustmentConfig& stage_config) : config(stage_config) {}
  BundleAdjustmentConfig config;

  void give(RefineJob job, BundleResult result) { solved_.emplace(std::move(job), std::move(result)); }
  BundleAdjustmentReport run(BundleEdit& edit, Workers& workers);

 private:
  std::optional<std::pair<RefineJob, BundleResult>> solved_;
};

// Receives the progress in percent.
using TellProgress = std::function<void(int percent)>;

// Adjusts a map at the end of a run: all its key frames, or those after adjusted_until, up to which it was adjusted
// as a whole already. Returns how uncertain the paths are then.
PathErrors adjust_whole(BundleEdit& edit, MapId map_id, const BundleAdjustmentConfig& config,
                        std::optional<SetId> adjusted_until = std::nullopt, const TellProgress& tell = {});

}  // namespace coslam
