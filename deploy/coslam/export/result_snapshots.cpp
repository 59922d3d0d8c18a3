// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/result_snapshots.h"

#include <algorithm>

namespace coslam::exporting {
namespace {

constexpr double kCloud_s = 1.0, kCloudBytes_per_s = 1.5e6, kPaths_s = 1.0;
constexpr std::size_t kMostOfPath = 500;  // poses
constexpr double kPointBytes = 28;
constexpr double kState_s = 0.25, kPoseHolds_s = 0.2;

}  // namespace

bool ResultSnapshots::due(std::optional<TimeNs>* last, TimeNs t_ns, double period_s) const {
  const bool at_the_end = next_ == timeline_.instants.size();
  if (*last && !at_the_end && to_seconds(t_ns - **last) < period_s) return false;
  *last = t_ns;
  return true;
}

std::shared_ptr<const PublicMoving> ResultSnapshots::moving_at(TimeNs t_ns) {
  // The newest that is not later; rows are of frame sets, whose stamps are those of one of their frames.
  auto after = timeline_.moving.upper_bound(t_ns);
  auto out = std::make_shared<PublicMoving>();
  if (after != timeline_.moving.begin()) *out = std::prev(after)->second;
  timeline_.moving.erase(timeline_.moving.begin(), after);
  const bool something = !out->maps.empty();
  if (!something && !moves_) return nullptr;  // it was told that all is at rest
  moves_ = something;
  out->t_ns = t_ns;
  out->main = timeline_.main;
  return out;
}

std::shared_ptr<const PublicCloud> ResultSnapshots::cloud_at(TimeNs t_ns) {
  const auto seen = std::ranges::upper_bound(timeline_.points, t_ns, {}, &std::pair<TimeNs, ros::StaticPoint>::first);
  const auto count = static_cast<std::size_t>(seen - timeline_.points.begin());
  const double period_s = std::max(kCloud_s, kPointBytes * static_cast<double>(count) / kCloudBytes_per_s);
  if ((count == told_points_ && cloud_ns_) || !due(&cloud_ns_, t_ns, period_s)) return nullptr;
  told_points_ = count;
  auto out = std::make_shared<PublicCloud>();
  out->t_ns = t_ns;
  out->main = timeline_.main;
  for (auto p = timeline_.points.begin(); p != seen; ++p) out->points.push_back(p->second);
  return out;
}

std::shared_ptr<const PublicPaths> ResultSnapshots::paths_at(TimeNs t_ns) {
  if (!due(&paths_ns_, t_ns, kPaths_s)) return nullptr;
  auto out = std::make_shared<PublicPaths>();
  out->t_ns = t_ns;
  out->main = timeline_.main;
  for (const Agent& agent : timeline_.agents) {
    const Told& told = told_[agent.name];
    if (!told.newest) continue;
    PublicPath path{.agent = agent.name, .map = told.newest->map, .cam_from_map = {}};
    const auto whole = std::ranges::find(agent.paths, path.map, &std::pair<MapId, Trajectory>::first);
    const auto end = std::ranges::upper_bound(whole->second, t_ns, {}, &StampedPose::t_ns);
    const auto count = static_cast<std::size_t>(end - whole->second.begin());
    // A power of two, so that the poses stay the same from one path to the next.
    std::size_t stride = 1;
    while (count / stride > kMostOfPath) stride *= 2;
    for (std::size_t i = 0; i < count; i += stride)
      path.cam_from_map.emplace_back(whole->second[i].t_ns, whole->second[i].cam_from_world);
    out->cameras.push_back(std::move(path));
  }
  return out;
}

std::shared_ptr<const PublicTracks> ResultSnapshots::tracks_until(TimeNs t_ns) {
  const auto after = timeline_.images.upper_bound(t_ns);
  if (after == timeline_.images.begin()) return nullptr;
  auto out = std::make_shared<PublicTracks>();
  out->t_ns = t_ns;
  out->main = timeline_.main;
  for (auto image = timeline_.images.begin(); image != after; ++image) {
    for (PublicImage& of_agent : image->second) {
      Told& told = told_[of_agent.agent];
      told.tracks = of_agent.tracks.size();
      told.bound = static_cast<std::size_t>(std::ranges::count_if(
          of_agent.tracks, [](const PublicTrack& t) { return t.state != PublicTrackState::kNone; }));
      out->cameras.push_back(std::move(of_agent));
    }
  }
  timeline_.images.erase(timeline_.images.begin(), after);
  return out;
}

PublicAgent ResultSnapshots::agent_at(const Agent& agent, const Told& told, TimeNs t_ns) const {
  PublicAgent out;
  out.facts.name = agent.name;
  out.facts.camera = CameraId(static_cast<std::uint16_t>(agent.run.value - 1));
  out.facts.status.agent = agent.name;
  out.facts.status.frame_ms = static_cast<float>(agent.frame_ms);
  out.run = agent.run;
  out.alive = true;
  out.rate_hz = agent.rate_hz;
  out.frames_due = out.frames_used = told.frames;
  out.facts.path = agent.path;
  out.tracks = told.tracks;
  out.bound = told.bound;
  out.camera = agent.camera;
  if (!told.newest) {
    out.why = "it has no place in any map yet";
    return out;
  }
  out.map = told.newest->map;
  out.scale_known = timeline_.scale_known && out.map == timeline_.main;
  if (to_seconds(t_ns - told.newest->capture_ns) < kPoseHolds_s) {
    out.standing = PublicStanding::kTracking;
    out.cam_from_map = told.newest->cam_from_map;
  } else if (const auto why = why_lost(agent, t_ns)) {
    out.standing = PublicStanding::kLost;
    out.why = *why;
  } else if (t_ns < agent.last_ns) {
    out.standing = PublicStanding::kUnheard;
    out.why = "no image of it reached the map";
  } else {
    out.alive = false;
    out.why = "its images have ended";
  }
  return out;
}

// By the newest event that tells; empty: it was not lost then.
std::optional<std::string> ResultSnapshots::why_lost(const Agent& agent, TimeNs t_ns) const {
  std::optional<std::string> why;
  for (const PublicEvent& e : timeline_.events) {
    if (e.t_ns > t_ns) break;
    if (e.agents != std::vector{agent.name}) continue;
    const std::string lost = agent.name + " is lost ";
    why = e.kind == "lost" && e.text.starts_with(lost) ? std::optional(e.text.substr(lost.size())) : std::nullopt;
  }
  return why;
}

std::shared_ptr<const PublicState> ResultSnapshots::state_at(TimeNs t_ns) {
  if (!due(&state_ns_, t_ns, kState_s)) return nullptr;
  auto out = std::make_shared<PublicState>();
  out->t_ns = out->wall_ns = t_ns;
  out->main = timeline_.main;
  out->scale_known = timeline_.scale_known;
  TimeNs groups_ns = -1;
  for (const ResultGroupRow& row : timeline_.groups) {
    if (row.t_ns > t_ns) break;
    if (row.t_ns != groups_ns) out->groups.clear();
    groups_ns = row.t_ns;
    out->groups.push_back(row.agents);
  }
  for (const Agent& agent : timeline_.agents) {
    PublicAgent& public_agent = out->agents.emplace_back(agent_at(agent, told_[agent.name], t_ns));
    for (std::size_t g = 0; g < out->groups.size(); ++g) {
      if (std::ranges::count(out->groups[g], agent.name) > 0) public_agent.group = static_cast<int>(g);
    }
  }
  out->points = told_points_;
  out->maps = timeline_.maps;
  out->frame_sets = static_cast<int>(next_);
  out->stages["frame_set"] = {.sum = timeline_.ms_per_set * static_cast<double>(next_), .count = next_};
  return out;
}

std::optional<Snapshot> ResultSnapshots::next() {
  if (next_ == timeline_.instants.size()) return std::nullopt;
  const ResultTimeline::Instant& now = timeline_.instants[next_++];
  Snapshot out;
  auto poses = std::make_shared<PublicPoses>();
  poses->t_ns = now.t_ns;
  poses->main = timeline_.main;
  poses->cameras = now.poses;
  out.poses = poses;
  for (const PublicPose& pose : now.poses) {
    Told& told = told_[pose.agent];
    told.newest = pose;
    ++told.frames;
  }
  out.moving = moving_at(now.t_ns);
  out.cloud = cloud_at(now.t_ns);
  out.paths = paths_at(now.t_ns);
  out.tracks = tracks_until(now.t_ns);
  auto state = state_at(now.t_ns);
  if (state && out.moving) {
    auto counted = std::make_shared<PublicState>(*state);
    for (const auto& [map, in_map] : out.moving->maps) {
      counted->moving_points += in_map.points.size();
      counted->objects += in_map.objects.size();
    }
    state = counted;
  }
  out.state = state;
  const bool last = next_ == timeline_.instants.size();
  while (next_event_ < timeline_.events.size() && (last || timeline_.events[next_event_].t_ns <= now.t_ns))
    out.events.push_back(timeline_.events[next_event_++]);
  return out;
}

}  // namespace coslam::exporting
