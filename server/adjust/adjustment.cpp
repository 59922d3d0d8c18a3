// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/adjust/adjustment.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace coslam {

TakenAdjustment TakeAdjustment::run(MapEdit& edit) {
  if (!solved_) return {};
  const auto& [job, result] = *solved_;
  const TakenAdjustment taken{.taken = true,
                              .usable = result.usable,
                              .extent = job.extent,
                              .map = job.map,
                              .report = apply_refine(edit, job, result)};
  solved_.reset();
  return taken;
}

PlannedAdjustment PlanAdjustment::run(MapEdit& edit, const FrameSet& set, const TakenAdjustment& taken,
                                      const MeetReport& met, const RefineConfig& refine) {
  if (taken.taken) in_flight_ = false;
  // One that a change of the map overtook is planned again.
  const bool done = taken.taken && taken.extent == RefineExtent::kOutline && (taken.report.applied || !taken.usable);
  if (done && taken.map == outline_) outline_ = MapId();
  if (met.to_adjust != MapId()) outline_ = met.to_adjust;
  const bool key_frame = decide_key_frame(edit, set, config);
  return {key_frame, plan_job(edit.map(), key_frame, refine)};
}

bool PlanAdjustment::plan_job(const Map& map, bool key_frame, const RefineConfig& refine) {
  const bool outline = outline_ != MapId();
  if (!refine.enabled || in_flight_ || !(key_frame || outline)) return false;
  std::vector<MapId> maps;
  for (const MapCamera& c : map.cameras()) {
    if (c.map != MapId() && std::find(maps.begin(), maps.end(), c.map) == maps.end()) maps.push_back(c.map);
  }
  if (maps.empty()) return false;
  const MapId of = outline ? outline_ : maps[static_cast<std::size_t>(plans_) % maps.size()];
  planned_ = plan_refine(map, of, outline ? RefineExtent::kOutline : RefineExtent::kWindow, refine);
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

std::vector<LensChange> adjust_whole(MapEdit& edit, MapId of, const RefineConfig& config) {
  std::vector<LensChange> lenses(config.intrinsics ? edit.map().cameras().size() : 0);
  for (const RefineExtent extent : {RefineExtent::kOutline, RefineExtent::kWhole}) {
    auto job = plan_refine(edit.map(), of, extent, config);
    if (!job) break;
    job->problem.lenses = lenses;
    const BundleResult result = solve_refine(*job);
    apply_refine(edit, *job, result);
    if (result.usable) lenses = result.lenses;
    if (extent != RefineExtent::kWhole || !result.usable) continue;
    const auto share = pose_share(edit.map(), *job, result);
    for (std::size_t i = 0; i < share.size(); ++i) {
      const MapPoint* p = edit.map().find(job->points[i]);
      if (p != nullptr) edit.move_point(*p, p->position, p->covariance + share[i]);
    }
  }
  return lenses;
}

}  // namespace coslam
