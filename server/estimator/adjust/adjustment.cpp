// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/adjustment.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "server/estimator/adjust/lens.h"

namespace coslam {

TakenAdjustment TakeAdjustment::run(BundleEdit& edit, Workers& workers) {
  if (!solved_) return {};
  const auto& [job, result] = *solved_;
  const TakenAdjustment taken{.taken = true,
                              .usable = result.usable,
                              .extent = job.extent,
                              .map = job.map,
                              .report = apply_refine(edit, job, result, workers)};
  solved_.reset();
  return taken;
}

PlannedAdjustment PlanAdjustment::run(KeyFramesEdit& edit, const FrameSet& set, const TakenAdjustment& taken,
                                      const MeetReport& met, const RefineConfig& refine, Workers& workers) {
  if (taken.taken) in_flight_ = false;
  // One that a change of the map overtook is planned again.
  const bool done = taken.taken && taken.extent == RefineExtent::kOutline && (taken.report.applied || !taken.usable);
  if (done && taken.map == outline_) outline_ = MapId();
  if (taken.report.lens_step2 > kOnItsWay2) due_[taken.map] = 0;
  if (met.to_adjust != MapId()) {
    outline_since_ = met.to_adjust == outline_ ? std::min(outline_since_, met.adjust_since) : met.adjust_since;
    outline_ = met.to_adjust;
  }
  const bool key_frame = decide_key_frame(edit, set, config);
  return {key_frame, plan_job(edit.map(), key_frame, refine, workers)};
}

bool PlanAdjustment::plan_job(const Map& map, bool key_frame, const RefineConfig& refine, Workers& workers) {
  const bool outline = outline_ != MapId();
  if (!refine.enabled || in_flight_ || !(key_frame || outline)) return false;
  std::vector<MapId> maps;
  for (const MapCamera& c : map.cameras()) {
    if (c.map != MapId() && std::find(maps.begin(), maps.end(), c.map) == maps.end()) maps.push_back(c.map);
  }
  if (maps.empty()) return false;
  const MapId of = outline ? outline_ : maps[static_cast<std::size_t>(plans_) % maps.size()];
  if (outline) {
    planned_ = plan_outline_since(map, of, outline_since_, refine, workers);
  } else if (outline_is_due(map, of)) {
    planned_ = plan_outline_since(map, of, SetId(), refine, workers);
    // Until then the windows reach as far, and hold the scale better.
    constexpr std::size_t kWindows = 2;
    if (planned_) planned_->for_lenses = map.key_frames().size() < kWindows * static_cast<std::size_t>(refine.window);
    const bool breathes = std::ranges::any_of(map.cameras(), [](const MapCamera& c) { return c.breathing > 0; });
    if (planned_ && (breathes || zooms_are_due(map, of))) planned_->zooms = true;
  } else {
    planned_ = plan_refine(map, of, RefineExtent::kWindow, refine, workers);
  }
  if (planned_) {
    ++plans_;
  } else if (outline) {
    outline_ = MapId();  // too little to adjust, or part of another map by now
  }
  return planned_.has_value();
}

bool PlanAdjustment::outline_is_due(const Map& map, MapId of) {
  constexpr std::size_t kFirst = 8, kMost = 400, kPart = 4;
  const std::size_t keys = map.key_frames().size();
  std::size_t& due = due_.try_emplace(of, kFirst).first->second;
  if (keys < due || keys > kMost) return false;
  due = keys + std::max<std::size_t>(1, keys / kPart);
  return true;
}

bool PlanAdjustment::zooms_are_due(const Map& map, MapId of) {
  constexpr std::size_t kFirst = 16;
  const std::size_t keys = map.key_frames().size();
  std::size_t& due = zooms_due_.try_emplace(of, kFirst).first->second;
  if (keys < due) return false;
  due = 2 * keys;
  return true;
}

std::optional<RefineJob> PlanAdjustment::take_job() {
  if (!planned_) return std::nullopt;
  in_flight_ = true;
  return std::exchange(planned_, std::nullopt);
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

PathErrors adjust_whole(BundleEdit& edit, MapId of, const RefineConfig& config, std::optional<SetId> since,
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
