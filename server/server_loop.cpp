// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/server_loop.h"

#include <algorithm>
#include <utility>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/flow/latest_slot.h"

namespace coslam {
namespace {

constexpr std::uint32_t kRefineDueSets =
    3;  // lock-step: the solution is taken in so many sets after its plan, no sooner or later
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

// One bundle adjustment at a time, beside the map thread.
class ServerLoop::Refiner {
 public:
  struct Solved {
    RefineJob job;
    BundleResult result;
    std::chrono::steady_clock::duration took;
  };
  explicit Refiner(bool threaded) {
    if (!threaded) return;
    worker_.emplace("refine", [this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        std::optional<RefineJob> job = jobs_.take();
        if (!job) return;
        results_.put(solve(std::move(*job)));
      }
    });
  }
  ~Refiner() {
    jobs_.close();
    results_.close();
  }
  Refiner(const Refiner&) = delete;
  Refiner& operator=(const Refiner&) = delete;

  bool busy() const { return busy_; }
  SetId planned_at() const { return planned_at_; }
  void start(RefineJob job, SetId now) {
    busy_ = true;
    planned_at_ = now;
    if (worker_) {
      jobs_.put(std::move(job));
    } else {
      inline_job_ = std::move(job);
    }
  }
  std::optional<Solved> take(bool wait) {
    if (!busy_) return std::nullopt;
    std::optional<Solved> solved;
    if (inline_job_) {
      solved = solve(std::move(*inline_job_));
      inline_job_.reset();
    } else {
      solved = wait ? results_.take() : results_.try_take();
    }
    busy_ = !solved.has_value();
    return solved;
  }

 private:
  static Solved solve(RefineJob job) {
    const auto begin = std::chrono::steady_clock::now();
    BundleResult result = solve_refine(job);
    return {std::move(job), std::move(result), std::chrono::steady_clock::now() - begin};
  }

  LatestSlot<RefineJob> jobs_;
  LatestSlot<Solved> results_;
  std::optional<RefineJob> inline_job_;
  bool busy_ = false;
  SetId planned_at_;
  std::optional<Worker> worker_;  // last: joins before what it uses goes
};

ServerLoop::ServerLoop(ServerLink& link, RunId run, const ServerLoopConfig& config)
    : link_(link),
      config_(config),
      server_(run, config.server.map),
      sync_(config.server.sync),
      refiner_(std::make_unique<Refiner>(config.refine_in_thread)) {
  if (!config.out.empty()) store_.emplace(config.out, config.server.events);
  server_.keep_journal(store_ && config.server.events.enabled);
  if (config_.expected_agents.empty()) {
    started_ = true;
    start_utc_ns_ = utc_ns();
  }
  send_status();
}

ServerLoop::~ServerLoop() = default;

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
  if (const auto* silent = std::get_if<AgentSilent>(&event)) {
    const auto at = agents_.find(silent->agent);
    // In lock-step a slow agent is waited for; one that died is reported gone.
    if (at != agents_.end() && at->second.run == silent->agent_run && !lockstep()) {
      log_warn("agent " + silent->agent + " is silent");
      sync_.set_silent(at->second.camera);
    }
  }
}

void ServerLoop::on_hello(const Hello& hello) {
  const auto& expected = config_.expected_agents;
  if (!expected.empty() && std::find(expected.begin(), expected.end(), hello.agent) == expected.end()) {
    link_.refuse(hello, "agent " + hello.agent + " is not one that this server waits for");
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
  const bool lockstep = hello.pacing == Pacing::kLockstep;
  lockstep_ |= lockstep;
  sync_.add(agent.camera, hello.rate_hz, lockstep);
  log_info("agent " + hello.agent + (back ? " is back" : " joined"));
}

void ServerLoop::on_frame(const JoinedFrame& joined) {
  const auto at = agents_.find(joined.frame.agent);
  if (at == agents_.end() || at->second.run != joined.frame.agent_run) return;
  CameraFrame frame{at->second.camera, joined.frame, joined.patches, joined.descriptors};
  // A pose in the map of a server before this one says nothing here.
  if (frame.frame.server_run != server_.run()) frame.frame.pose_state = PoseState::kNone;
  const bool used = sync_.push(std::move(frame), monotonic_ns());
  // A replay that joined late or began anew catches up with the others.
  if (!used && lockstep()) link_.send(server_.acknowledge(at->second.camera, joined.frame));
}

void ServerLoop::on_status(const AgentStatus& status) {
  const auto at = agents_.find(status.agent);
  if (at == agents_.end() || at->second.run != status.agent_run) return;
  at->second.last_status = status;
  if (status.state == AgentState::kFinished && !at->second.ended) {
    log_info("agent " + status.agent + " has ended");
    at->second.ended = true;
    sync_.finish(at->second.camera);
    server_.set_alive(at->second.camera, false);
  }
}

void ServerLoop::on_gone(const std::string& name, RunId run) {
  waiting_.erase(name);
  const auto at = agents_.find(name);
  if (at == agents_.end() || at->second.run != run || at->second.ended) return;
  log_warn("agent " + name + " is gone; the others go on");
  at->second.ended = true;
  sync_.finish(at->second.camera);
  server_.set_alive(at->second.camera, false);
}

void ServerLoop::run_set(const FrameSet& set) {
  exchange_refinement(set.id);
  for (const MapPatch& patch : server_.step(set)) link_.send(patch);
  for (const MovingState& state : server_.moving()) link_.send(state);
  for (const std::string& warning : server_.take_warnings()) log_warn(warning);
  if (auto job = server_.take_refine_job()) refiner_->start(std::move(*job), set.id);
  if (store_) store_->record(set, server_);
}

void ServerLoop::exchange_refinement(SetId now) {
  if (!refiner_->busy()) return;
  // Lock-step: at a fixed set, so that the machine's speed does not show in the result.
  const bool due = now.value >= refiner_->planned_at().value + kRefineDueSets;
  if (lockstep() && !due) return;
  give_refined(lockstep());
}

void ServerLoop::give_refined(bool wait) {
  if (auto solved = refiner_->take(wait)) {
    server_.give_refined(std::move(solved->job), std::move(solved->result), solved->took);
  }
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
  for (const auto& [name, agent] : agents_) status.agents.push_back(name);
  link_.send_status(status);
}

void ServerLoop::finish(const nlohmann::ordered_json& effective) {
  give_refined(true);
  server_.finish();
  for (const std::string& warning : server_.take_warnings()) log_warn(warning);
  make_report(effective);
  if (store_) store_->finish(server_, report_);
  stopping_ = true;
  send_status();
}

void ServerLoop::make_report(const nlohmann::ordered_json& effective) {
  report_ = nlohmann::ordered_json::object();
  report_["version"] = COSLAM_VERSION;
  report_["frame_sets"] = server_.counts().frame_sets;
  std::uint64_t frames = 0, dropped = 0;
  nlohmann::ordered_json agents;
  for (const auto& [name, agent] : agents_) {
    nlohmann::ordered_json a = camera_report(server_, agent.camera);
    const AgentStatus& s = agent.last_status;
    a["dropped"] = s.dropped;
    const auto own = nlohmann::ordered_json::parse(s.report_json.empty() ? "{}" : s.report_json, nullptr, false);
    if (own.is_object()) a.update(own);
    const LinkBytes bytes = link_.bytes(name);
    a["bytes_up"] = bytes.up;
    a["bytes_down"] = bytes.down;
    // Per second of played time, so that the figure holds at any speed of replay.
    const auto& played = server_.map().camera(agent.camera).frames;
    const double seconds = played.size() < 2 ? 0 : to_seconds(played.back().capture_ns - played.front().capture_ns);
    a["kb_per_s_up"] = seconds > 0 ? static_cast<double>(bytes.up) / 1000.0 / seconds : 0.0;
    a["kb_per_s_down"] = seconds > 0 ? static_cast<double>(bytes.down) / 1000.0 / seconds : 0.0;
    frames += s.frames;
    dropped += s.dropped;
    agents[name] = a;
  }
  report_["frames"] = frames;
  report_["dropped"] = dropped;
  report_["late_frames"] = sync_.late();
  report_["agents"] = agents;
  report_["server"] = server_report(server_);
  nlohmann::ordered_json rejected = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < kRejectionCount; ++i) {
    const auto reason = static_cast<Rejection>(i);
    if (link_.rejections()[reason] > 0) rejected[std::string(name_of(reason))] = link_.rejections()[reason];
  }
  report_["rejected"] = rejected;
  report_["configuration"] = effective;
}

}  // namespace coslam
