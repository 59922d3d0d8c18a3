// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/adjust/adjustment.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace coslam {

TakenAdjustment TakeAdjustment::run(MapEdit& edit, Workers& workers) {
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

PlannedAdjustment PlanAdjustment::run(MapEdit& edit, const FrameSet& set, const TakenAdjustment& taken,
                                      const MeetReport& met, const RefineConfig& refine, Workers& workers) {
  if (taken.taken) in_flight_ = false;
  // One that a change of the map overtook is planned again.
  const bool done = taken.taken && taken.extent == RefineExtent::kOutline && (taken.report.applied || !taken.usable);
  if (done && taken.map == outline_) outline_ = MapId();
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
  planned_ = outline ? plan_outline_since(map, of, outline_since_, refine, workers)
                     : plan_refine(map, of, RefineExtent::kWindow, refine, workers);
  if (planned_) {
    ++plans_;
  } else if (outline) {
    outline_ = MapId();  // too little to adjust, or part of another map by now
  }
  return planned_.has_value();
}

std::optional<RefineJob> PlanAdjustment::take_job() {
  if (!planned_) return std::nullopt;
  in_flight_ = true;
  return std::exchange(planned_, std::nullopt);
}

std::vector<std::string> lens_doubts(const Map& map, MapId of) {
  constexpr double kWrong = 0.1;  // no calibration is so far off
  const auto job = plan_lens_check(map, of);
  if (!job) return {};
  const BundleResult result = solve_refine(*job);
  if (!result.usable) return {};
  std::vector<std::string> out;
  for (const MapCamera& c : map.cameras()) {
    const double scale = std::exp(result.lenses[c.id.value].log_focal());
    if (std::abs(scale - 1) < kWrong) continue;
    out.push_back("the images of agent " + c.name + " fit a focal length of about " +
                  std::to_string(std::lround(scale * c.model.focal_px())) + " px, not the " +
                  std::to_string(std::lround(c.model.focal_px())) + " of its calibration: is that the right one?");
  }
  return out;
}

namespace {

// An outline is solved in about a fifth of the time of the whole.
constexpr int kOutlineShare_percent = 20;

void tell_of(RefineJob* job, int from_percent, int to_percent, const TellProgress& tell) {
  if (!tell) return;
  const int all = std::max(1, job->config.max_iterations);
  job->config.after_iteration = [=](int done) {
    tell(from_percent + (to_percent - from_percent) * std::min(done, all) / all);
  };
}

// What the uncertain poses of a solution add to its points.
void add_pose_share(MapEdit& edit, const RefineJob& job, const BundleResult& result) {
  const auto share = pose_share(edit.map(), job, result);
  for (std::size_t i = 0; i < share.size(); ++i) {
    const MapPoint* p = edit.map().find(job.points[i]);
    if (p != nullptr) edit.move_point(*p, p->position, p->covariance + share[i]);
  }
}

}  // namespace

std::vector<LensChange> adjust_whole(MapEdit& edit, MapId of, const RefineConfig& config, std::optional<SetId> since,
                                     const TellProgress& tell) {
  std::vector<LensChange> lenses(config.intrinsics ? edit.map().cameras().size() : 0);
  for (const RefineExtent extent : {RefineExtent::kOutline, RefineExtent::kWhole}) {
    const bool whole = extent == RefineExtent::kWhole;
    if (since && !whole) continue;
    auto job = since ? plan_refine_since(edit.map(), of, *since, config) : plan_refine(edit.map(), of, extent, config);
    if (!job) break;
    job->problem.lenses = lenses;
    tell_of(&*job, whole && !since ? kOutlineShare_percent : 0, whole ? 100 : kOutlineShare_percent, tell);
    const BundleResult result = solve_refine(*job);
    apply_refine(edit, *job, result);
    if (result.usable) lenses = result.lenses;
    if (whole && result.usable) add_pose_share(edit, *job, result);
  }
  if (tell) tell(100);
  return lenses;
}

}  // namespace coslam
