// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/server_loop.h"

#include <algorithm>
#include <utility>

#include "common/base/error.h"
#include "common/base/log.h"
#include "server/report.h"

namespace coslam {
namespace {

constexpr auto kStatusPeriod = std::chrono::seconds(1);
constexpr double kStartDelay_s = 0.3;  // between the word to start and played time 0

TimeNs utc_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

TimeNs monotonic_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

ServerLoop::ServerLoop(ServerLink& link, RunId run, const ServerLoopConfig& config)
    : link_(link),
      config_(config),
      server_(run, config.server.map),
      sync_(config.server.sync),
      refiner_(config.refine_in_thread) {
  if (!config.out.empty()) store_.emplace(config.out, config.server.events);
  server_.keep_journal(store_ && config.server.events.enabled);
  if (config_.expected_agents.empty()) {
    started_ = true;
    start_utc_ns_ = utc_ns();
  }
  send_status();
}

bool ServerLoop::poll(std::chrono::milliseconds timeout) {
  std::optional<ServerEvent> event = link_.next_event(timeout);
  while (event) {
    handle(*event);
    event = link_.next_event(std::chrono::milliseconds(0));
  }
  while (const std::optional<FrameSet> set = sync_.pop(monotonic_ns())) run_set(*set);
  if (std::chrono::steady_clock::now() - last_status_ > kStatusPeriod) send_status();
  if (!started_ || config_.expected_agents.empty()) return true;
  return !std::all_of(agents_.begin(), agents_.end(), [](const auto& a) { return a.second.ended; });
}

void ServerLoop::handle(const ServerEvent& event) {
  if (const auto* hello = std::get_if<Hello>(&event)) on_hello(*hello);
  if (const auto* frame = std::get_if<JoinedFrame>(&event)) on_frame(*frame);
  if (const auto* status = std::get_if<AgentStatus>(&event)) on_status(*status);
  if (const auto* gone = std::get_if<AgentGone>(&event)) on_gone(gone->agent, gone->agent_run);
  if (const auto* silent = std::get_if<AgentSilent>(&event)) on_silent(silent->agent, silent->agent_run);
}

void ServerLoop::on_hello(const Hello& hello) {
  const auto& expected = config_.expected_agents;
  if (!expected.empty() && std::find(expected.begin(), expected.end(), hello.agent) == expected.end()) {
    link_.refuse(hello, "agent " + hello.agent + " is not one that this server waits for");
    return;
  }
  if (agents_.size() >= kMostAgents && !agents_.contains(hello.agent)) {
    link_.refuse(hello, "the map server has met " + std::to_string(kMostAgents) +
                            " agents of different names, as many as it can: restart it");
    return;
  }
  if (started_) {
    admit(hello);
    return;
  }
  waiting_[hello.agent] = hello;
  start_if_complete();
}

void ServerLoop::start_if_complete() {
  for (const std::string& name : config_.expected_agents) {
    if (!waiting_.contains(name)) return;
  }
  for (const std::string& name : config_.expected_agents) admit(waiting_.at(name));
  waiting_.clear();
  started_ = true;
  start_utc_ns_ = utc_ns() + to_ns(kStartDelay_s);
  send_status();
}

void ServerLoop::admit(const Hello& hello) {
  const bool back = agents_.contains(hello.agent);
  Agent& agent = agents_[hello.agent];
  agent.camera = server_.admit(hello);
  agent.run = hello.agent_run;
  agent.ended = false;
  server_.set_alive(agent.camera, true);
  const bool waits = hello.pacing == Pacing::kLockstep;
  lockstep_ |= waits;
  sync_.add(agent.camera, hello.rate_hz, waits);
  log_info("agent " + hello.agent + (back ? " is back" : " joined"));
}

ServerLoop::Agent* ServerLoop::find(const std::string& name, RunId run) {
  const auto at = agents_.find(name);
  return at == agents_.end() || at->second.run != run ? nullptr : &at->second;
}

void ServerLoop::on_frame(const JoinedFrame& joined) {
  const Agent* agent = find(joined.frame.agent, joined.frame.agent_run);
  if (agent == nullptr) return;
  CameraFrame frame{agent->camera, joined.frame, joined.patches, joined.descriptors};
  // A pose in the map of a server before this one says nothing here.
  if (frame.frame.server_run != server_.run()) frame.frame.pose_state = PoseState::kNone;
  const bool used = sync_.push(std::move(frame), monotonic_ns());
  // A replay that joined late or began anew catches up with the others.
  if (!used && lockstep_) link_.send(server_.acknowledge(agent->camera, joined.frame));
}

void ServerLoop::on_status(const AgentStatus& status) {
  Agent* agent = find(status.agent, status.agent_run);
  if (agent == nullptr) return;
  agent->last_status = status;
  if (status.state != AgentState::kFinished || agent->ended) return;
  log_info("agent " + status.agent + " has ended");
  end(*agent);
}

void ServerLoop::on_silent(const std::string& name, RunId run) {
  const Agent* agent = find(name, run);
  // In lock-step a slow agent is waited for; one that died is reported gone.
  if (agent == nullptr || lockstep_) return;
  log_warn("agent " + name + " is silent");
  sync_.set_silent(agent->camera);
}

void ServerLoop::on_gone(const std::string& name, RunId run) {
  waiting_.erase(name);
  Agent* agent = find(name, run);
  if (agent == nullptr || agent->ended) return;
  log_warn("agent " + name + " is gone; the others go on");
  end(*agent);
}

void ServerLoop::end(Agent& agent) {
  agent.ended = true;
  sync_.finish(agent.camera);
  server_.set_alive(agent.camera, false);
}

void ServerLoop::run_set(const FrameSet& set) {
  give_refined(refiner_.take_due(set.id, lockstep_));
  for (const MapPatch& patch : server_.step(set)) link_.send(patch);
  for (const MovingState& state : server_.moving()) link_.send(state);
  for (const std::string& warning : server_.take_warnings()) log_warn(warning);
  if (auto job = server_.take_refine_job()) refiner_.start(std::move(*job), set.id);
  if (store_) store_->record(set, server_);
}

void ServerLoop::give_refined(std::optional<RefineSolution> solution) {
  if (solution) server_.give_refined(std::move(solution->job), std::move(solution->result), solution->took);
}

void ServerLoop::send_status() {
  last_status_ = std::chrono::steady_clock::now();
  ServerStatus status;
  status.server_run = server_.run();
  status.started = started_;
  status.stopping = stopping_;
  status.start_utc_ns = start_utc_ns_;
  status.frame_sets = static_cast<std::uint32_t>(server_.counts().frame_sets);
  status.points = static_cast<std::uint32_t>(server_.map().points().size());
  for (const bool ended : {false, true}) {
    for (const auto& [name, agent] : agents_) {
      if (agent.ended == ended) status.agents.push_back(name);
    }
  }
  link_.send_status(status);
}

void ServerLoop::finish(const nlohmann::ordered_json& configuration) {
  give_refined(refiner_.take(true));
  server_.finish();
  for (const std::string& warning : server_.take_warnings()) log_warn(warning);
  std::vector<ReportedAgent> agents;
  for (const auto& [name, agent] : agents_) agents.push_back({name, agent.camera, agent.last_status});
  report_ = make_report(server_, sync_, link_, agents, configuration);
  if (store_) store_->finish(server_, report_);
  stopping_ = true;
  send_status();
}

}  // namespace coslam
