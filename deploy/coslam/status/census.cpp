// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/status/census.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/base/printed.h"
#include "common/base/text.h"
namespace coslam {
namespace {

constexpr std::size_t kMostUnanswered = 256;  // frames

double seconds(Instant from, Instant to) { return std::chrono::duration<double>(to - from).count(); }

const char* word_of(PoseState state) {
  switch (state) {
    case PoseState::kTracked:
      return "tracked";
    case PoseState::kLost:
      return "lost";
    case PoseState::kNone:
      break;
  }
  return "none";
}

const char* word_of(AgentState state) {
  switch (state) {
    case AgentState::kRunning:
      return "running";
    case AgentState::kFinished:
      return "finished";
    case AgentState::kWaiting:
      break;
  }
  return "waiting";
}

}  // namespace

void Census::add(const ServerStatus& status, std::uint64_t, Instant) { servers_[status.server_run] = status; }

void Census::add(const Hello& hello, std::uint64_t bytes, Instant now) {
  heard(hello.agent, hello.agent_run, bytes, now);
}

void Census::add(const AgentStatus& status, std::uint64_t bytes, Instant now) {
  heard(status.agent, status.agent_run, bytes, now).status = status;
}

void Census::add(const TrackFrame& frame, std::uint64_t bytes, Instant now) {
  Agent& agent = heard(frame.agent, frame.agent_run, bytes, now);
  // In lock-step a frame may come again.
  if (!agent.unanswered.emplace(frame.frame, now).second) return;
  if (agent.unanswered.size() > kMostUnanswered) agent.unanswered.erase(agent.unanswered.begin());
  if (agent.frames++ == 0) agent.first_frame = now;
  agent.last_frame = now;
}

void Census::add(const PatchReply& reply, std::uint64_t bytes, Instant now) {
  heard(reply.agent, reply.agent_run, bytes, now);
}

void Census::add(const DescriptorReply& reply, std::uint64_t bytes, Instant now) {
  heard(reply.agent, reply.agent_run, bytes, now);
}

void Census::add(const MapPatch& patch, std::uint64_t bytes, Instant now) {
  Agent& agent = heard(patch.agent, patch.agent_run, 0, now);
  agent.bytes_down += bytes;
  agent.group = patch.group;
  const auto frame = agent.unanswered.find(patch.after_frame);
  if (frame == agent.unanswered.end()) return;
  ++agent.answers;
  agent.lag_s += seconds(frame->second, now);
  agent.unanswered.erase(agent.unanswered.begin(), std::next(frame));
}

void Census::add(const AgentImages& images, std::uint64_t bytes, Instant now) {
  Agent& agent = heard(images.agent, images.agent_run, 0, now);
  agent.bytes_down += bytes;
  agent.images = images.images;
  agent.complete = images.complete;
}

void Census::add(const MovingState& state, std::uint64_t, Instant) { moving_[{state.server_run, state.map}] = state; }

void Census::set_alive(RunId run, bool alive) { alive_[run] = alive; }

bool Census::alive(RunId run) const {
  const auto found = alive_.find(run);
  return found == alive_.end() || found->second;
}

Census::Agent& Census::heard(const std::string& name, RunId run, std::uint64_t bytes, Instant now) {
  const auto [at, is_new] = agents_.try_emplace(run);
  if (is_new) at->second.heard_since = now;
  at->second.name = name;
  at->second.bytes_up += bytes;
  return at->second;
}

std::string Census::refusal(RunId run) const {
  for (const auto& [server_run, server] : servers_) {
    if (const auto reason = refusal_of(server, run)) return *reason;
  }
  return {};
}

std::string Census::state_of(RunId run, const Agent& agent) const {
  if (!refusal(run).empty()) return "refused";
  if (agent.complete) return "ended";
  if (!alive(run)) return "silent";
  return word_of(agent.status ? agent.status->state : AgentState::kWaiting);
}

const char* Census::state_of(RunId run, const ServerStatus& server) const {
  return !alive(run) ? "silent" : server.stopping ? "stopping" : server.started ? "running" : "waiting";
}

Census::Figures Census::figures_of(RunId run, const Agent& agent, Instant now) const {
  const double played_s = seconds(agent.first_frame, agent.last_frame), heard_s = seconds(agent.heard_since, now);
  const auto kilobytes_per_s = [&](std::uint64_t bytes) {
    return heard_s > 0 ? 1e-3 * static_cast<double>(bytes) / heard_s : 0.0;
  };
  Figures out;
  out.status = agent.status.value_or(AgentStatus());
  out.images = agent.images;
  out.name = agent.name;
  out.state = state_of(run, agent);
  out.pose = word_of(out.status.pose_state);
  if (agent.group != GroupId()) out.group = agent.group.value;
  out.rate_hz = agent.frames > 1 && played_s > 0 ? (agent.frames - 1) / played_s : 0.0;
  if (agent.answers > 0) out.lag_ms = 1e3 * agent.lag_s / agent.answers;
  out.up_kb_s = kilobytes_per_s(agent.bytes_up);
  out.down_kb_s = kilobytes_per_s(agent.bytes_down);
  out.refused = refusal(run);
  return out;
}

std::uint64_t Census::Figures::captured() const {
  return images ? images->captured() : std::uint64_t{status.frames} + status.dropped + status.left_out;
}

std::vector<Census::Figures> Census::agents(Instant now) const {
  std::vector<Figures> all;
  for (const auto& [run, agent] : agents_) all.push_back(figures_of(run, agent, now));
  std::ranges::stable_sort(all, {}, &Figures::name);
  return all;
}

std::vector<std::string> Census::gone_agents() const {
  std::vector<std::string> names;
  for (const auto& [run, server] : servers_) {
    for (const std::string& name : server.agents) {
      if (std::ranges::none_of(agents_, [&](const auto& a) { return a.second.name == name; })) names.push_back(name);
    }
  }
  return names;
}

std::string Census::text(Instant now) const {
  std::string text;
  for (const auto& [run, s] : servers_) {
    text += printed("map server %s: %s, %u frame sets, %u points\n", format_hex(run.value).c_str(), state_of(run, s),
                    s.frame_sets, s.points);
  }
  if (servers_.empty()) text += "no map server\n";
  text += printed("%-16s %-8s %-8s %5s %8s %8s %6s %8s %6s %7s %8s %9s\n", "agent", "state", "pose", "group", "images",
                  "tracked", "tracks", "ms/frame", "Hz", "lag ms", "kB/s up", "kB/s down");
  const std::vector<Figures> all = agents(now);
  for (const Figures& f : all) {
    text += printed("%-16s %-8s %-8s", f.name.c_str(), f.state.c_str(), f.pose.c_str());
    text += f.group ? printed(" %5u", *f.group) : printed(" %5s", "-");
    text += printed(" %8llu", static_cast<unsigned long long>(f.captured()));
    text += f.images ? printed(" %7.1f%%", f.images->percent(ImageFate::kTracked)) : printed(" %8s", "-");
    text += printed(" %6u %8.1f %6.1f", f.status.tracks, f.status.frame_ms, f.rate_hz);
    text += f.lag_ms ? printed(" %7.1f", *f.lag_ms) : printed(" %7s", "-");
    text += printed(" %8.1f %9.1f\n", f.up_kb_s, f.down_kb_s);
    if (f.images && !f.images->losses().empty()) text += "  " + losses_of(f.name, *f.images) + "\n";
    if (f.status.image_fault == ImageFault::kNone) continue;
    text += "  its images are not to be believed: " + std::string(words_of(f.status.image_fault).why) + "\n";
  }
  for (const auto& [key, state] : moving_) {
    const char* unit = state.scale_known ? "m" : "units";
    for (const MovingObjectState& o : state.objects) {
      text += printed("object %u: %u points at %.2f %.2f %.2f, %.2f %s/s, %.2f x %.2f x %.2f %s\n", o.object.value,
                      static_cast<unsigned>(o.points), o.centroid.x(), o.centroid.y(), o.centroid.z(),
                      o.velocity_per_s.norm(), unit, o.extent.x(), o.extent.y(), o.extent.z(), unit);
    }
  }
  for (const std::string& name : gone_agents()) text += printed("%-16s %-8s\n", name.c_str(), "gone");
  for (const Figures& f : all) {
    if (!f.refused.empty()) text += "refused: " + f.refused + "\n";
  }
  return text;
}

std::string Census::json(Instant now) const {
  using Json = nlohmann::ordered_json;
  const auto images_of = [](const Figures& f) {
    Json out{{"captured", f.captured()}};
    for (std::size_t i = 0; f.images && i < kImageFates; ++i) {
      out[words_of(static_cast<ImageFate>(i)).name] = f.images->images[i];
    }
    return out;
  };
  const auto or_null = [](const auto& value) { return value ? Json(*value) : Json(); };
  Json servers = Json::array(), agents_now = Json::array(), objects = Json::array();
  for (const auto& [run, s] : servers_) {
    servers.push_back({{"run", format_hex(run.value)},
                       {"state", state_of(run, s)},
                       {"frame_sets", s.frame_sets},
                       {"points", s.points}});
  }
  for (const Figures& f : agents(now)) {
    agents_now.push_back({{"name", f.name},
                          {"state", f.state},
                          {"pose", f.pose},
                          {"group", or_null(f.group)},
                          {"images", images_of(f)},
                          {"tracks", f.status.tracks},
                          {"frame_ms", f.status.frame_ms},
                          {"rate_hz", f.rate_hz},
                          {"lag_ms", or_null(f.lag_ms)},
                          {"up_kb_s", f.up_kb_s},
                          {"down_kb_s", f.down_kb_s},
                          {"image_fault", words_of(f.status.image_fault).name},
                          {"refused", f.refused.empty() ? Json() : Json(f.refused)}});
  }
  for (const std::string& name : gone_agents()) agents_now.push_back({{"name", name}, {"state", "gone"}});
  for (const auto& [key, state] : moving_) {
    for (const MovingObjectState& o : state.objects) {
      objects.push_back({{"object", o.object.value},
                         {"map", key.second.value},
                         {"points", o.points},
                         {"centroid", {o.centroid.x(), o.centroid.y(), o.centroid.z()}},
                         {"speed_per_s", o.velocity_per_s.norm()},
                         {"scale_known", state.scale_known}});
    }
  }
  return Json{{"servers", servers}, {"agents", agents_now}, {"objects", objects}}.dump(-1, ' ', false,
                                                                                       Json::error_handler_t::replace) +
         "\n";
}

}  // namespace coslam
