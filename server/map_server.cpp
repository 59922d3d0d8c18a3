// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/map_server.h"

#include <algorithm>

namespace coslam {
namespace {

std::map<MapId, int> frames_by_map(const Map& map) {
  std::map<MapId, int> frames;
  for (const MapCamera& c : map.cameras()) {
    for (const FramePose& f : c.frames) {
      if (f.valid()) ++frames[f.map];
    }
  }
  return frames;
}

}  // namespace

MapServer::MapServer(RunId run, const MapServerConfig& config)
    : run_{run}, config_(config), edit_(config.map), pipeline_(config.stages) {}

CameraId MapServer::admit(const Hello& hello) {
  for (const MapCamera& c : map().cameras()) {
    if (c.name != hello.agent) continue;
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

int MapServer::map_count() const { return static_cast<int>(frames_by_map(map()).size()); }

MapId MapServer::largest_map() const {
  MapId best;
  int most = 0;
  for (const auto& [id, n] : frames_by_map(map())) {
    if (n <= most) continue;
    most = n;
    best = id;
  }
  return best;
}

}  // namespace coslam
