// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/map_server.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace coslam {

MapServer::MapServer(RunId run, const MapServerConfig& config)
    : run_(run),
      config_(config),
      edit_(config.map),
      meetings_(config.meet),
      grouping_(config.group),
      clocks_(config.clock),
      objects_(config.objects),
      moving_writer_(run),
      tag_scale_(config.tags) {
  config_.verify.leave_moved = config_.classify.enabled;
}

CameraId MapServer::admit(const Hello& hello) {
  for (const MapCamera& c : map().cameras()) {
    if (c.name != hello.agent) continue;
    if (c.run != hello.agent_run) {
      edit_.restart_camera(c.id, hello.agent_run, hello.camera);
      clocks_.forget(c.id);
    }
    return c.id;
  }
  const CameraId id = edit_.add_camera(hello.agent, hello.agent_run, hello.camera);
  writers_.emplace(id, PatchWriter(run_, config_.patches));
  return id;
}

void MapServer::set_alive(CameraId camera, bool alive) { edit_.set_alive(camera, alive); }

std::vector<MapPatch> MapServer::step(const FrameSet& set) {
  const auto whole = times_.measure("frame_set");
  ++counts_.frame_sets;
  edit_.journal().begin_set();
  edit_.ingest(set);
  {
    const auto t = times_.measure("apply_refined");
    apply_refined();
  }
  {
    const auto t = times_.measure("localise");
    const LocaliseReport r = localise(edit_, set, config_.localise);
    count("tracked", r.tracked);
    count("lost", r.lost);
  }
  if (const InterPoseReport r = run_inter_pose(set); r.calls > 0) {
    counts_.inter_pose_calls += r.calls;
    count("inter_posed", r.posed);
    count("rescued", r.rescued);
  }
  {
    const auto t = times_.measure("start");
    count("maps_started", start(edit_, set, config_.start).started);
  }
  MeetReport met;
  {
    const auto t = times_.measure("meet");
    met = meetings_.step(edit_, set, graph_);
    count("images_described", met.described);
    count("sightings", met.sightings);
    count("placed", met.placed);
    count("loops_closed", met.closed);
    count("places_linked", met.linked);
    count("places_expected", met.expected);
    count("meetings_doubted", met.doubted);
    counts_.merges += met.merged;
    if (met.to_adjust != MapId()) refine_outline_ = met.to_adjust;
  }
  {
    const auto t = times_.measure("verify");
    const VerifyReport r = verify(edit_, set, config_.verify);
    count("gate_inside", r.inside);
    count("gate_outside", r.outside);
    count("unbound", r.unbound);
    count("filter_updates", r.updated);
  }
  {
    const auto t = times_.measure("classify");
    const ClassifyReport r = classify(edit_, set, config_.classify);
    count("became_uncertain", r.uncertain);
    count("became_dynamic", r.dynamic);
    count("became_static", r.stopped);
    count("found_false", r.removed);
    count("rebound", r.rebound);
    count("moving_track_sets", r.moving_tracks);
  }
  {
    const auto t = times_.measure("clock");
    clocks_.step(edit_, set);
  }
  {
    const auto t = times_.measure("register");
    const RegisterReport r = register_tracks(edit_, set, config_.registration);
    count("register_candidates", r.candidates);
    count("registered", r.registered);
  }
  {
    const auto t = times_.measure("map_intra");
    count("created_intra", map_intra(edit_, set, config_.intra).created);
  }
  {
    const auto t = times_.measure("group");
    graph_ = grouping_.step(map(), set);
  }
  if (set.id.value % static_cast<std::uint32_t>(config_.inter.period) == 0) {
    const auto t = times_.measure("map_inter");
    const MapInterReport r = map_inter(edit_, set, graph_, config_.inter);
    count("inter_matched", r.matched);
    count("created_inter", r.created);
  }
  if (config_.classify.enabled && set.id.value % static_cast<std::uint32_t>(config_.inter.moving_period) == 0) {
    const auto t = times_.measure("map_moving");
    count("joined_moving", map_moving(edit_, set, graph_, config_.inter).moving);
  }
  if (set.id.value % static_cast<std::uint32_t>(config_.fuse.period) == 0) {
    const auto t = times_.measure("fuse");
    const FuseReport r = fuse_points(edit_, set, config_.fuse);
    count("fuse_candidates", r.candidates);
    count("fused", r.fused);
  }
  {
    const auto t = times_.measure("cull");
    count("culled", cull(edit_, set, config_.cull).removed);
  }
  set_scale(set, met.merged > 0);
  {
    const auto t = times_.measure("objects");
    const ObjectsReport r = objects_.step(map(), set, in_metres_);
    count("objects_started", r.started);
    count("object_sets", r.objects);
    moving_ = moving_writer_.write(map(), objects_.objects(), in_metres_);
  }
  {
    const auto t = times_.measure("key_frame");
    plan_refinement(decide_key_frame(edit_, set, config_.key_frame));
  }
  edit_.journal().end_set();
  const auto t = times_.measure("correct");
  return write_patches(set, met);
}

// Timed only when it had something to do.
InterPoseReport MapServer::run_inter_pose(const FrameSet& set) {
  const auto begin = std::chrono::steady_clock::now();
  const InterPoseReport r = inter_pose(edit_, set, graph_, config_.inter_pose);
  if (r.calls > 0) times_.add("inter_pose", std::chrono::steady_clock::now() - begin);
  return r;
}

MapPatch MapServer::acknowledge(CameraId camera, const TrackFrame& frame) {
  return writers_.at(camera).acknowledge(map(), map().camera(camera), frame);
}

std::vector<MapPatch> MapServer::write_patches(const FrameSet& set, const MeetReport& met) {
  std::vector<MapPatch> patches;
  for (const CameraFrame& cf : set.frames) {
    const auto request = met.requests.find(cf.camera);
    patches.push_back(
        writers_.at(cf.camera).write(edit_, map().camera(cf.camera), cf.frame,
                                     request == met.requests.end() ? DescriptorRequest::kNone : request->second));
    patches.back().scale_known = in_metres_.contains(map().camera(cf.camera).map);
    patches.back().group = GroupId(static_cast<std::uint32_t>(graph_.group_of(cf.camera) + 1));
  }
  return patches;
}

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

int MapServer::map_count() const { return static_cast<int>(frames_by_map(map()).size()); }

MapId MapServer::largest_map() const {
  const std::map<MapId, int> frames = frames_by_map(map());
  MapId best;
  int most = 0;
  for (const auto& [id, n] : frames) {
    if (n > most) {
      most = n;
      best = id;
    }
  }
  return best;
}

void MapServer::plan_refinement(bool key_frame) {
  const bool outline = refine_outline_ != MapId();
  if (!config_.refine.enabled || in_flight_ || !(key_frame || outline)) return;
  std::vector<MapId> maps;
  for (const MapCamera& c : map().cameras()) {
    if (c.map != MapId() && std::find(maps.begin(), maps.end(), c.map) == maps.end()) maps.push_back(c.map);
  }
  if (maps.empty()) return;
  const MapId of = outline ? refine_outline_ : maps[static_cast<std::size_t>(counts_.refinements) % maps.size()];
  planned_ = plan_refine(map(), of, outline ? RefineExtent::kOutline : RefineExtent::kWindow, config_.refine);
  if (planned_) {
    ++counts_.refinements;
  } else if (outline) {
    refine_outline_ = MapId();  // too little to adjust, or part of another map by now
  }
}

std::optional<RefineJob> MapServer::take_refine_job() {
  if (!planned_) return std::nullopt;
  in_flight_ = true;
  return std::exchange(planned_, std::nullopt);
}

void MapServer::give_refined(RefineJob job, BundleResult result, std::chrono::steady_clock::duration took) {
  times_.add(job.extent == RefineExtent::kOutline ? "refine_outline" : "refine", took);
  refined_.emplace(std::move(job), std::move(result));
}

void MapServer::apply_refined() {
  if (!refined_) return;
  const RefineReport r = apply_refine(edit_, refined_->first, refined_->second);
  const bool outline = refined_->first.extent == RefineExtent::kOutline;
  count("refine_applied", r.applied ? 1 : 0);
  // One that a change of the map overtook is planned again.
  const RefineJob& job = refined_->first;
  if (outline && job.map == refine_outline_ && (r.applied || !refined_->second.usable)) refine_outline_ = MapId();
  count("refine_outliers", r.outliers);
  count("refine_observations", r.observations);
  refined_.reset();
  in_flight_ = false;
}

void MapServer::set_scale(const FrameSet& set, bool merged) {
  if (config_.baseline_m > 0) return set_scale_by_baseline();
  if (config_.tags.side_m <= 0) return;
  const auto t = times_.measure("tag_scale");
  take(tag_scale_.step(edit_, set, merged));
}

void MapServer::take(const TagScaleReport& r) {
  in_metres_ = tag_scale_.in_metres();
  count("tags_measured", r.measured);
  count("scaled_by_tags", r.scaled);
  warnings_.insert(warnings_.end(), r.doubts.begin(), r.doubts.end());
}

// The first instant at which the first two cameras have a pose in the same map tells its scale; again when that map
// became part of another, whose scale is its own.
void MapServer::set_scale_by_baseline() {
  if (map().cameras().size() < 2) return;
  const MapCamera &a = map().cameras()[0], &b = map().cameras()[1];
  if (scaled_map_ != MapId() && a.frame_at(scaled_at_)->map == scaled_map_) return;
  for (const FramePose& fa : a.frames) {
    const FramePose* fb = b.frame_at(fa.set);
    if (!fa.valid() || fb == nullptr || fb->map != fa.map) continue;
    const double length = (fa.cam_from_world.center() - fb->cam_from_world.center()).norm();
    if (length <= 0) return;
    scaled_map_ = fa.map;
    in_metres_ = {fa.map};
    scaled_at_ = fa.set;
    edit_.transform(fa.map, {config_.baseline_m / length, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()},
                    Why::kScaleKnown);
    return;
  }
}

void MapServer::finish() {
  const auto t = times_.measure("finish");
  edit_.journal().begin_set();
  apply_refined();
  if (!config_.refine.enabled) return;
  for (const RefineExtent extent : {RefineExtent::kOutline, RefineExtent::kWhole}) {
    const auto job = plan_refine(map(), largest_map(), extent, config_.refine);
    if (!job) break;
    const BundleResult result = solve_refine(*job);
    apply_refine(edit_, *job, result);
    if (extent != RefineExtent::kWhole || !result.usable) continue;
    const auto share = pose_share(map(), *job, result);
    for (std::size_t i = 0; i < share.size(); ++i) {
      if (const MapPoint* p = map().find(job->points[i])) edit_.move_point(*p, p->position, p->covariance + share[i]);
    }
  }
  // The poses that tell the scale are known better now.
  if (config_.baseline_m > 0) {
    scaled_map_ = MapId();
    set_scale_by_baseline();
  } else {
    take(tag_scale_.finish(edit_));
  }
}

}  // namespace coslam
