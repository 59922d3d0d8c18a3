// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/roster.h"

#include <algorithm>
#include <utility>

namespace coslam {

std::optional<std::string> Roster::why_not(const Hello& hello) const {
  if (!expected_.empty() && std::ranges::find(expected_, hello.agent) == expected_.end())
    return "agent " + hello.agent + " is not one that this server waits for";
  if (agents_.size() >= kMostAgents && !knows(hello.agent)) {
    return "the map server has met " + std::to_string(kMostAgents) +
           " agents of different names, as many as it can: restart it";
  }
  // One in lock-step is waited for as long as it takes, which nobody who lives in real time may have to bear.
  const auto differs = [&](const std::string& name, Pacing pacing) {
    return name != hello.agent && pacing != hello.pacing;
  };
  if (std::ranges::any_of(agents_,
                          [&](const auto& a) { return !a.second.ended && differs(a.first, a.second.pacing); }) ||
      std::ranges::any_of(waiting_, [&](const auto& h) { return differs(h.first, h.second.pacing); })) {
    const bool lockstep = hello.pacing == Pacing::kLockstep;
    return "agent " + hello.agent + " plays in " + (lockstep ? "lock-step" : "real time") +
           " and those that are here in " + (lockstep ? "real time" : "lock-step") +
           ": give all the same kind of --rate";
  }
  return std::nullopt;
}

std::vector<Hello> Roster::take_complete() {
  const auto missing = [&](const std::string& name) { return !waiting_.contains(name); };
  if (std::ranges::any_of(expected_, missing)) return {};
  std::vector<Hello> all;
  for (const std::string& name : expected_) all.push_back(waiting_.at(name));
  waiting_.clear();
  return all;
}

void Roster::admit(const Hello& hello, CameraId camera, bool seen_before) {
  Agent& agent = agents_[hello.agent];
  if (agent.run != hello.agent_run) {
    agent.images.begin(seen_before);
    agent.begun = false;
    agent.missed = 0;
  }
  agent.camera = camera;
  agent.run = hello.agent_run;
  agent.pacing = hello.pacing;
  agent.ended = agent.said_images = false;
}

Roster::Agent* Roster::find(const std::string& name, RunId run) {
  const auto at = agents_.find(name);
  return at == agents_.end() || at->second.run != run ? nullptr : &at->second;
}

bool Roster::all_ended() const {
  return std::ranges::all_of(agents_, [](const auto& a) { return a.second.ended; });
}

std::vector<std::string> Roster::names() const {
  std::vector<std::string> all;
  for (const bool ended : {false, true}) {
    for (const auto& [name, agent] : agents_) {
      if (agent.ended == ended) all.push_back(name);
    }
  }
  return all;
}

void Roster::note_missed(const TrackFrame& frame, bool late, std::optional<TimeNs> past_ns, Agent* agent) {
  constexpr TimeNs kInTheMiddle_ns = 1'000'000'000;
  if (agent->begun || frame.capture_ns >= kFirstDate_ns) return;
  if (late) {
    agent->missed = frame.frame.value + 1;
    agent->past_ns = past_ns.value_or(0);
  } else if (agent->missed == 0 && frame.capture_ns > kInTheMiddle_ns) {
    agent->missed = frame.frame.value;
    agent->past_ns = frame.capture_ns;
  }
  agent->begun |= !late;
}

void Roster::count_used(const FrameSet& set, const Map& map) {
  for (const CameraFrame& f : set.frames) {
    const MapCamera& camera = map.camera(f.camera);
    const FramePose* pose = camera.frame_at(set.id);
    Agent& agent = agents_.at(camera.name);
    agent.images.used(pose != nullptr && pose->valid());
    if (agent.images.frames_posed() == 0) agent.seen.look(camera);
  }
}

std::vector<ReportedAgent> Roster::reported(const MapServer& server) const {
  std::vector<ReportedAgent> all;
  const std::vector<MapFrames> maps = server.maps();
  for (const auto& [name, agent] : agents_) {
    const ImageAccount images = account_of(agent, server, maps);
    all.push_back({name, agent.camera, agent.last_status, images, problem_of(name, agent, images)});
  }
  return all;
}

// A map that is older than this server holds frames of other days, and does not tell whose are of this one.
ImageAccount Roster::account_of(const Agent& agent, const MapServer& server, const std::vector<MapFrames>& maps) {
  if (server.restored_until()) return agent.images.at_end(agent.images.frames_posed(), 0);
  std::uint64_t tracked = 0, in_other_maps = 0;
  for (const MapFrames& map : maps) {
    const auto frames = map.frames.find(agent.camera);
    if (frames == map.frames.end()) continue;
    (&map == &maps.front() ? tracked : in_other_maps) += static_cast<std::uint64_t>(frames->second);
  }
  return agent.images.at_end(tracked, in_other_maps);
}

std::string Roster::problem_of(const std::string& name, const Agent& agent, const ImageAccount& images) {
  constexpr std::uint64_t kWorthSaying = 5;
  const std::uint64_t placed = images[ImageFate::kTracked] + images[ImageFate::kInOtherMaps];
  if (agent.missed >= kWorthSaying) return late_images(name, agent.missed, images.captured(), agent.past_ns);
  return placed > 0 ? "" : name + " " + why_no_pose(images, faults_of(agent.last_status.report_json), agent.seen);
}

}  // namespace coslam
