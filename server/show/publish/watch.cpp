// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/watch.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace coslam {
namespace {

constexpr double kPoses_s = 1.0 / 30, kMoving_s = 1.0 / 15, kTracks_s = 0.2, kPaths_s = 1.0;
constexpr double kCloud_s = 1.0, kCloudBytes_per_s = 1.5e6;
constexpr std::size_t kCloudPoints = 4000;  // at each frame set
constexpr double kState_s = 0.25, kStateUnasked_s = 1.0;

// Everything was carried elsewhere, more than an adjustment does.
bool moved_whole(const Journal& journal) {
  return std::ranges::any_of(journal.events(), [](const Event& e) {
    return e.kind == EventKind::kMapMerged || (e.kind == EventKind::kMapMoved && e.why != Why::kAdjusted);
  });
}

PublicStanding standing_of(const MapCamera& c) {
  if (c.map == MapId() || c.frames.empty()) return PublicStanding::kNone;
  if (c.lost_sets > 0 || !c.frames.back().valid()) return PublicStanding::kLost;
  return c.frames.back().joint ? PublicStanding::kRelative : PublicStanding::kTracking;
}

// Empty while nothing is known of the clock.
std::optional<double> clock_offset_s(const ClockOffset& clock) {
  constexpr double kKnown_s = 0.02;
  return clock.sigma_s < kKnown_s ? std::optional(clock.offset_s) : std::nullopt;
}

void put_times(const MapServer& server, PublicState* state) {
  for (const auto& [name, h] : server.times().stages()) state->stages[name] = stage_time_of(h);
}

void put_groups(const Map& map, const ViewGraph& graph, PublicState* state) {
  for (const auto& group : graph.groups) {
    auto& names = state->groups.emplace_back();
    for (const CameraId c : group) names.push_back(map.camera(c).name);
  }
  for (const ViewEdge& e : graph.edges)
    state->links.push_back({map.camera(e.first).name, map.camera(e.second).name, e.shared});
}

}  // namespace

MapWatch::MapWatch(const MapServer& server) {
  for (const MapFrames& m : server.maps()) {
    for (const auto& [camera, frames] : m.frames) main_.begin_with(m.map, frames);
  }
}

template <class T>
std::shared_ptr<const T> MapWatch::dated(const Map& map, T part) const {
  part.t_ns = map.now_ns();
  part.main = main_.id();
  return std::make_shared<const T>(std::move(part));
}

Snapshot MapWatch::after_set(const FrameSet& set, const MapServer& server, PartSet wanted, TimeNs now_ns,
                             const AskLoop& loop) {
  const Map& map = server.map();
  main_.after_set(map, set, server.journal());
  count_frames(set);
  Snapshot out;
  out.events = happenings_.after_set(map, server.journal(), server.report<ViewGraph>());
  if (cloud_.under_way() && moved_whole(server.journal())) cloud_.give_up();
  if (wanted.has(Part::kPoses) && poses_pace_.due(now_ns, kPoses_s))
    out.poses = dated(map, copy_poses(map, set, server.run(), &odom_));
  if (wanted.has(Part::kMoving) && moving_pace_.due(now_ns, kMoving_s))
    out.moving = dated(map, copy_moving(map, server.report<ObjectsReport>().list));
  if (wanted.has(Part::kTracks) && tracks_pace_.due(now_ns, kTracks_s)) out.tracks = dated(map, copy_tracks(map, set));
  slow_parts(server, wanted, now_ns, loop, &out);
  return out;
}

Snapshot MapWatch::in_between(const MapServer& server, PartSet wanted, TimeNs now_ns, const AskLoop& loop) {
  Snapshot out;
  out.events = happenings_.comings(server.map());
  slow_parts(server, wanted, now_ns, loop, &out);
  return out;
}

Snapshot MapWatch::at_the_end(const MapServer& server, PartSet wanted, TimeNs now_ns, const AskLoop& loop) {
  const Map& map = server.map();
  Snapshot out;
  out.events = happenings_.comings(map);
  out.state = dated(map, state(server, now_ns, loop()));
  if (wanted.has(Part::kPaths)) out.paths = dated(map, copy_paths(map));
  if (wanted.has(Part::kCloud)) {
    cloud_.begin(map);
    out.cloud = dated(map, *cloud_.go_on(map, std::numeric_limits<std::size_t>::max()));
  }
  return out;
}

void MapWatch::slow_parts(const MapServer& server, PartSet wanted, TimeNs now_ns, const AskLoop& loop, Snapshot* out) {
  const Map& map = server.map();
  if (wanted.has(Part::kPaths) && paths_pace_.due(now_ns, kPaths_s)) out->paths = dated(map, copy_paths(map));
  if (wanted.has(Part::kCloud)) out->cloud = some_cloud(server, now_ns);
  if (state_pace_.due(now_ns, wanted.has(Part::kState) ? kState_s : kStateUnasked_s))
    out->state = dated(map, state(server, now_ns, loop()));
}

std::shared_ptr<const PublicCloud> MapWatch::some_cloud(const MapServer& server, TimeNs now_ns) {
  const Map& map = server.map();
  if (!cloud_.under_way()) {
    const double period_s = std::max(kCloud_s, static_cast<double>(cloud_bytes_) / kCloudBytes_per_s);
    if (cloud_of_ == map.now() || !cloud_pace_.due(now_ns, period_s)) return nullptr;
    cloud_.begin(map);
  }
  const auto cloud = cloud_.go_on(map, kCloudPoints);
  if (!cloud) return nullptr;
  cloud_of_ = map.now();
  cloud_bytes_ = cloud->points.size() * sizeof(ros::StaticPoint);
  cloud->t_ns = map.now_ns();
  cloud->main = main_.id();
  return cloud;
}

void MapWatch::count_frames(const FrameSet& set) {
  for (const CameraFrame& cf : set.frames) {
    Frames& f = frames_[cf.camera];
    if (f.run != cf.frame.agent_run) f = {cf.frame.agent_run, cf.frame.frame, cf.frame.frame, 0};
    f.newest = std::max(f.newest, cf.frame.frame);
    ++f.used;
  }
}

PublicAgent MapWatch::agent(const MapServer& server, const AgentFacts& facts) const {
  const MapCamera& c = server.map().camera(facts.camera);
  PublicAgent out;
  out.facts = facts;
  out.run = c.run;
  out.alive = c.alive;
  out.map = c.map;
  out.group = server.report<ViewGraph>().group_of(c.id);
  out.standing = standing_of(c);
  out.why = happenings_.why_lost(c);
  if (facts.status.image_fault != ImageFault::kNone) {
    if (out.standing != PublicStanding::kNone) out.standing = PublicStanding::kLost;
    out.why = "its images are not to be believed: " + std::string(words_of(facts.status.image_fault).why);
  }
  if (c.frames.size() >= kLeastFrames) out.rate_hz = 1 / c.frame_interval_s;
  const auto frames = frames_.find(c.id);
  if (frames != frames_.end() && frames->second.run == c.run) {
    out.frames_due = frames->second.newest.value - frames->second.first.value + 1;
    out.frames_used = frames->second.used;
  }
  out.tracks = c.tracks.size();
  out.bound = static_cast<std::size_t>(std::ranges::count_if(c.tracks, [](const auto& t) { return t.second.bound(); }));
  out.clock_offset_s = clock_offset_s(server.stage<ClockOffsets>().offset(c.id));
  const bool placed = out.standing == PublicStanding::kTracking || out.standing == PublicStanding::kRelative;
  if (placed) out.cam_from_map = c.frames.back().cam_from_world;
  out.scale_known = c.map != MapId() && server.scale_known(c.map);
  out.camera = c.model;
  return out;
}

PublicState MapWatch::state(const MapServer& server, TimeNs now_ns, LoopFacts loop) const {
  const Map& map = server.map();
  PublicState out;
  out.wall_ns = now_ns;
  out.run = server.run();
  out.scale_known = server.scale_known(main_.id());
  for (const AgentFacts& facts : std::exchange(loop.agents, {})) out.agents.push_back(agent(server, facts));
  out.loop = std::move(loop);
  put_groups(map, server.report<ViewGraph>(), &out);
  out.points = map.points().size();
  out.moving_points = map.moving_points().size();
  out.objects = server.report<ObjectsReport>().list.size();
  out.maps = main_.maps();
  out.key_frames = map.key_frames().size();
  const MapServerCounts counts = server.counts();
  out.frame_sets = counts.frame_sets;
  out.merges = counts.merges;
  out.inter_pose_calls = counts.inter_pose_calls;
  out.refinements = counts.refinements;
  put_times(server, &out);
  out.stages["view"] = out.loop.watching;
  return out;
}

}  // namespace coslam
