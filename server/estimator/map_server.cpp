// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map_server.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "server/estimator/adjust/final_poses.h"

namespace coslam {
namespace {

std::map<MapId, MapFrames> frames_by_map(const Map& map) {
  std::map<MapId, MapFrames> all;
  for (const MapCamera& c : map.cameras()) {
    const auto add = [&](MapId id, int frames) {
      MapFrames& m = all[id];
      m.map = id;
      m.frames[c.id] += frames;
    };
    for (const auto& [map_id, frames] : c.past.placed) add(map_id, frames);
    for (const FramePose& f : c.present_frames()) {
      if (f.valid()) add(f.map, 1);
    }
  }
  return all;
}

int sum_of(const MapFrames& m) {
  int sum = 0;
  for (const auto& [camera, n] : m.frames) sum += n;
  return sum;
}

}  // namespace

MapServer::MapServer(RunId run, const MapServerConfig& config)
    : run_{run}, config_(config), edit_(config.map), pipeline_(config.stages) {}

CameraId MapServer::admit(const Hello& hello) {
  for (const MapCamera& c : map().cameras()) {
    if (c.name != hello.agent) continue;
    if (restored_until_) {
      met_since_.try_emplace(c.id, c.run == hello.agent_run ? c.run_since : SetId(restored_until_->value + 1));
    }
    if (c.run != hello.agent_run) {
      edit_.restart_camera(c.id, hello.agent_run, hello.camera);
      pipeline_.forget(c.id);
    }
    return c.id;
  }
  return edit_.add_camera(hello.agent, hello.agent_run, hello.camera);
}

// Agents undistort by their calibrations. Where more is known of the lens, all stages see tracks where that has them.
FrameSet MapServer::by_lenses(const FrameSet& set) const {
  FrameSet out = set;
  for (CameraFrame& cf : out.frames) {
    const MapCamera& c = map().camera(cf.camera);
    if (!c.lens.none()) cf.frame.tracks = seen_through(c.model, c.lens, cf.frame.tracks);
  }
  return out;
}

// Once for each camera, when its calibration is far off.
void MapServer::tell_of_lenses() {
  constexpr double kFar = 0.03;
  for (const MapCamera& c : map().cameras()) {
    const double scale = std::exp(c.lens.log_focal());
    if (std::abs(scale - 1) < kFar || !lenses_told_.insert(c.id).second) continue;
    warnings_.push_back("the images of agent " + c.name + " fit a focal length of about " +
                        std::to_string(std::lround(scale * c.model.focal_px())) + " px, not the " +
                        std::to_string(std::lround(c.model.focal_px())) + " " +
                        (c.model.guessed() ? "that was guessed" : "of its calibration") +
                        "; the map goes by the images");
  }
  for (const MapCamera& c : map().cameras()) {
    if (c.breathing == 0 || !breathing_told_.insert(c.id).second) continue;
    char most[16];
    std::snprintf(most, sizeof most, "%.1f", 100 * c.breathing);
    warnings_.push_back(
        "the focal length of agent " + c.name + " changes from image to image, by up to " + most +
        " %, as of a lens that keeps focusing: the map makes up for it, poses at the time only in part; "
        "a fixed focus is better");
  }
}

std::vector<MapPatch> MapServer::step(const FrameSet& seen) {
  const auto whole = report_.times.measure("frame_set");
  ++frame_sets_;
  edit_.journal().begin_set();
  const bool as_calibrated =
      std::ranges::all_of(seen.frames, [&](const CameraFrame& cf) { return map().camera(cf.camera).lens.none(); });
  std::optional<FrameSet> corrected;
  const FrameSet& set = as_calibrated ? seen : corrected.emplace(by_lenses(seen));
  edit_.ingest(set);
  pipeline_.step(set, edit_, run_, &report_);
  past_ = pipeline_.take_report<PastPart>();
  pipeline_.forget(past_.views);
  take(pipeline_.report<ScaleReport>());
  if (pipeline_.report<BundleAdjustmentReport>().report.applied) tell_of_lenses();
  note_adjusted();
  edit_.journal().end_set();
  return pipeline_.report<Corrections>().patches;
}

void MapServer::take(const ScaleReport& scale) {
  in_metres_ = scale.in_metres;
  warnings_.insert(warnings_.end(), scale.doubts.begin(), scale.doubts.end());
}

MapPatch MapServer::acknowledge(CameraId camera, const TrackFrame& frame) {
  return pipeline_.stage<MapRole::Answers>().acknowledge(map(), camera, frame, run_);
}

void MapServer::give_refined(RefineJob job, BundleResult result, std::chrono::steady_clock::duration took) {
  report_.times.add(job.extent == RefineExtent::kOutline ? "bundle_outline" : "bundle", took);
  pipeline_.stage<MapRole::TakesAdjustment>().give(std::move(job), std::move(result));
}

// What was adjusted stays so when a newer map becomes part of it; not when loops are closed in it, or when what is not
// adjusted and as old becomes part of it.
void MapServer::note_adjusted() {
  const auto& moves = map().moves();
  for (; moves_seen_ < moves.size(); ++moves_seen_) {
    const auto& [from, into, by] = moves[moves_seen_];
    if (from == into) continue;
    const auto moved = adjusted_.extract(from);
    const bool old = restored_until_ && from.value < first_new_map_.value;
    if (!moved && old) adjusted_.erase(into);
    if (moved && !(restored_until_ && into.value < first_new_map_.value)) adjusted_.emplace(into, moved.mapped());
  }
  const auto& met = pipeline_.report<PlaceRecognitionReport>();
  if (met.closed > 0) adjusted_.erase(met.to_adjust);
}

// Maps that show one place and loops that were not seen, or not believed, while the run went on.
void MapServer::close_loops_offline() {
  const auto timer = report_.times.measure("close_loops_offline");
  edit_.journal().begin_set();
  const FrameSet none{map().now(), map().now_ns(), {}};
  pipeline_.run<MapRole::TakesAdjustment>(none, edit_, run_, &report_);
  pipeline_.run<MapRole::RemembersLastImages>(none, edit_, run_, &report_);
  auto& places = pipeline_.stage<MapRole::KnowsPlaces>();
  const auto joined = static_cast<long>(places.join_all(edit_).size());
  const OfflineLoopsReport back = places.close_loops_offline(edit_, largest_map());
  report_.counts["merges"] += joined;
  report_.counts["loops_closed"] += back.closed;
  report_.counts["places_linked"] += back.linked;
  if (joined > 0 || back.closed > 0) adjusted_.clear();
}

void MapServer::finish(const TellProgress& tell) {
  pipeline_.stage<MapRole::FindsMisdated>().finish(edit_);
  const BundleAdjustmentConfig& refine = config_.of<BundleAdjustmentConfig>();
  if (refine.at_end == "nothing") return;
  close_loops_offline();
  const auto adjusted = adjusted_.find(largest_map());
  const bool all = refine.at_end == "whole" || adjusted == adjusted_.end();
  adjust(all ? std::nullopt : std::optional(adjusted->second), tell);
}

void MapServer::finish_whole(const TellProgress& tell) {
  pipeline_.stage<MapRole::FindsMisdated>().finish(edit_);
  close_loops_offline();
  adjust(std::nullopt, tell);
}

void MapServer::adjust(std::optional<SetId> since, const TellProgress& tell) {
  const auto timer = report_.times.measure("finish");
  const BundleAdjustmentConfig& refine = config_.of<BundleAdjustmentConfig>();
  if (!refine.enabled) return;
  for (const MapCamera& c : map().cameras()) path_errors_[c.id] = {};
  for (const auto& [camera, path] : adjust_whole(edit_, largest_map(), refine, since, tell))
    path_errors_[camera] = path;
  tell_of_lenses();
  adjusted_[largest_map()] = map().now();
  const FinalPosesReport settled = refine_final_poses(edit_, largest_map());
  report_.counts["frames_settled"] += settled.changed;
  report_.counts["frames_placed_late"] += settled.placed;
  take(pipeline_.stage<MapRole::KnowsScale>().finish(edit_));
}

std::optional<PathError> MapServer::path_error(CameraId camera) const {
  const auto at = path_errors_.find(camera);
  return at == path_errors_.end() ? std::nullopt : std::optional(at->second);
}

MapServerCounts MapServer::counts() const {
  const auto of = [&](const char* name) {
    const auto at = report_.counts.find(name);
    return at == report_.counts.end() ? 0 : static_cast<int>(at->second);
  };
  return {frame_sets_, of("merges"), of("inter_pose_calls"), of("refinements"), report_.counts};
}

MemoryUse MapServer::memory() const {
  MemoryUse use = memory_of(map());
  pipeline_.add_memory(&use);
  return use;
}

std::vector<MapFrames> MapServer::maps() const {
  std::vector<MapFrames> all;
  for (auto& [id, frames] : frames_by_map(map())) all.push_back(frames);
  const auto largest =
      std::ranges::max_element(all, [](const MapFrames& a, const MapFrames& b) { return sum_of(a) < sum_of(b); });
  if (largest != all.end()) std::rotate(all.begin(), largest, std::next(largest));
  return all;
}

MapId MapServer::largest_map() const {
  const std::vector<MapFrames> all = maps();
  return all.empty() ? MapId() : all.front().map;
}

}  // namespace coslam
