// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/workers.h"
#include "server/estimator/adjust/certainty.h"
#include "server/estimator/adjust/key_frame.h"
#include "server/estimator/adjust/refine.h"
#include "server/estimator/places/meet.h"

// Bundle adjustment beside the frame sets: planned at one, handed out as a job, taken in at a later one. At most one is
// on its way.
namespace coslam {

struct TakenAdjustment {
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
class TakeAdjustment {
 public:
  static constexpr std::string_view kName = "refine";
  using Config = RefineConfig;
  explicit TakeAdjustment(const RefineConfig& of) : config(of) {}
  RefineConfig config;

  void give(RefineJob job, BundleResult result) { solved_.emplace(std::move(job), std::move(result)); }
  TakenAdjustment run(BundleEdit& edit, Workers& workers);

 private:
  std::optional<std::pair<RefineJob, BundleResult>> solved_;
};

struct PlannedAdjustment {
  bool key_frame = false, planned = false;
  void count(auto&& add) const { add("refinements", planned); }
};

// Decides whether the set is a key frame, and what is to be adjusted then: the newest key frames of one map, each map
// in turn; or the outline of one that became one of two or was drawn together, or has grown by a quarter: so the map is
// drawn straight while it is small, and what is wrong about a lens is found.
class PlanAdjustment {
 public:
  static constexpr std::string_view kName = "key_frame";
  using Config = KeyFrameConfig;
  explicit PlanAdjustment(const KeyFrameConfig& of) : config(of) {}
  KeyFrameConfig config;

  PlannedAdjustment run(KeyFramesEdit& edit, const FrameSet& set, const TakenAdjustment& taken, const MeetReport& met,
                        const RefineConfig& refine, Workers& workers);
  // The job that the last set planned; it is in flight until its solution was taken in.
  std::optional<RefineJob> take_job();

 private:
  bool outline_is_due(const Map& map, MapId of);
  bool zooms_are_due(const Map& map, MapId of);
  bool plan_job(const Map& map, bool key_frame, const RefineConfig& refine, Workers& workers);

  std::optional<RefineJob> planned_;
  bool in_flight_ = false;
  MapId outline_;  // whose outline is to be adjusted; 0 = none
  SetId outline_since_;
  int plans_ = 0;
  std::map<MapId, std::size_t> zooms_due_;  // key frames at which it is looked whether its cameras breathe
  std::map<MapId, std::size_t> due_;        // key frames that a map's outline is adjusted again with
};

// How far it is, percent.
using TellProgress = std::function<void(int percent)>;

// The last word: all key frames of a map, or those after `since`, before which it was adjusted as a whole already. How
// uncertain the paths are in the end.
PathErrors adjust_whole(BundleEdit& edit, MapId of, const RefineConfig& config,
                        std::optional<SetId> since = std::nullopt, const TellProgress& tell = {});

}  // namespace coslam
