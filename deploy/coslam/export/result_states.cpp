// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "deploy/coslam/export/result_snapshots.h"

namespace coslam::exporting {
namespace {

constexpr double kState_s = 0.25, kPoseHolds_s = 0.2;

}  // namespace

PublicAgent ResultSnapshots::agent_at(const Agent& agent, TimeNs t_ns) const {
  PublicAgent out;
  out.facts.name = agent.name;
  out.facts.camera = CameraId(static_cast<std::uint16_t>(agent.run.value - 1));
  out.facts.status.agent = agent.name;
  out.facts.status.frame_ms = static_cast<float>(agent.frame_ms);
  out.run = agent.run;
  out.alive = true;
  out.rate_hz = agent.rate_hz;
  out.frames_due = out.frames_used = agent.frames;
  out.facts.path = agent.path;
  out.tracks = agent.tracks;
  out.bound = agent.bound;
  out.camera = agent.camera;
  if (!agent.newest) {
    out.why = "it has no place in any map yet";
    return out;
  }
  out.map = agent.newest->map;
  out.scale_known = scale_known_ && out.map == main_;
  if (to_seconds(t_ns - agent.newest->capture_ns) < kPoseHolds_s) {
    out.standing = PublicStanding::kTracking;
    out.cam_from_map = agent.newest->cam_from_map;
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
  for (const PublicEvent& e : events_) {
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
  out->main = main_;
  out->scale_known = scale_known_;
  TimeNs groups_ns = -1;
  for (const ResultGroupRow& row : groups_) {
    if (row.t_ns > t_ns) break;
    if (row.t_ns != groups_ns) out->groups.clear();
    groups_ns = row.t_ns;
    out->groups.push_back(row.agents);
  }
  for (const Agent& agent : agents_) {
    PublicAgent& public_agent = out->agents.emplace_back(agent_at(agent, t_ns));
    for (std::size_t g = 0; g < out->groups.size(); ++g) {
      if (std::ranges::count(out->groups[g], agent.name) > 0) public_agent.group = static_cast<int>(g);
    }
  }
  out->points = told_points_;
  out->maps = maps_;
  out->frame_sets = static_cast<int>(next_);
  out->stages["frame_set"] = {.sum = ms_per_set_ * static_cast<double>(next_), .count = next_};
  return out;
}

}  // namespace coslam::exporting
