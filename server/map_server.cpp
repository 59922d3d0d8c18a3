// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/map_server.h"

#include <algorithm>

#include "server/adjust/settle.h"

namespace coslam {
namespace {

std::map<MapId, MapFrames> frames_by_map(const Map& map) {
  std::map<MapId, MapFrames> all;
  for (const MapCamera& c : map.cameras()) {
    for (const FramePose& f : c.frames) {
      if (!f.valid()) continue;
      MapFrames& m = all[f.map];
      m.map = f.map;
      ++m.frames[c.id];
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
      pipeline_.stage<ClockFinder>().forget(c.id);
    }
    return c.id;
  }
  return edit_.add_camera(hello.agent, hello.agent_run, hello.camera);
}

std::vector<MapPatch> MapServer::step(const FrameSet& set) {
  const auto whole = report_.times.measure("frame_set");
  ++frame_sets_;
  edit_.journal().begin_set();
  edit_.ingest(set);
  pipeline_.step(set, edit_, run_, &report_);
  take(pipeline_.report<ScaleReport>());
  edit_.journal().end_set();
  return pipeline_.report<Corrections>().patches;
}

void MapServer::take(const ScaleReport& scale) {
  in_metres_ = scale.in_metres;
  warnings_.insert(warnings_.end(), scale.doubts.begin(), scale.doubts.end());
}

MapPatch MapServer::acknowledge(CameraId camera, const TrackFrame& frame) {
  return pipeline_.stage<Correct>().acknowledge(map(), camera, frame, run_);
}

void MapServer::give_refined(RefineJob job, BundleResult result, std::chrono::steady_clock::duration took) {
  report_.times.add(job.extent == RefineExtent::kOutline ? "bundle_outline" : "bundle", took);
  pipeline_.stage<TakeAdjustment>().give(std::move(job), std::move(result));
}

void MapServer::finish() {
  const auto timer = report_.times.measure("finish");
  edit_.journal().begin_set();
  pipeline_.run<TakeAdjustment>({map().now(), map().now_ns(), {}}, edit_, run_, &report_);
  const RefineConfig& refine = config_.of<RefineConfig>();
  if (!refine.enabled) return;
  const std::vector<std::string> doubts = lens_doubts(map(), largest_map());
  warnings_.insert(warnings_.end(), doubts.begin(), doubts.end());
  lenses_ = adjust_whole(edit_, largest_map(), refine);
  const SettleReport settled = settle_frames(edit_, largest_map());
  report_.counts["frames_settled"] += settled.changed;
  report_.counts["frames_placed_late"] += settled.placed;
  take(pipeline_.stage<Scale>().finish(edit_));
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
  use["places"] = pipeline_.stage<Meetings>().remembered_bytes();
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
