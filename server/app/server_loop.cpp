// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/server_loop.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "common/base/error.h"
#include "common/base/log.h"
#include "server/app/stop_signals.h"
#include "server/estimator/correct/pose_writer.h"
#include "server/keep/observe/run_folder.h"

namespace coslam {
namespace {

constexpr TimeNs kStatusPeriod_ns = 1'000'000'000;
// Around the start: by the word that took least, agents tell what their clocks are off by.
constexpr TimeNs kStartingPeriod_ns = 100'000'000, kStarting_ns = 1'000'000'000;
constexpr TimeNs kFirstDate_ns = 1'000'000'000'000'000'000;  // stamps of recordings count from their beginning
constexpr double kStartDelay_s = 0.3;                        // between the word to start and played time 0

int threads_of(const ServerConfig& config) {
  constexpr unsigned kMost = 8;
  if (config.threads > 0) return config.threads;
  return static_cast<int>(std::clamp(std::thread::hardware_concurrency() / 2, 1U, kMost));
}

}  // namespace

ServerLoop::ServerLoop(ServerLink& link, RunId run, const ServerLoopConfig& config)
    : link_(link),
      config_(config),
      workers_("map helper", threads_of(config.server)),
      server_(run, config.server.map),
      sync_(config.server.sync),
      stamps_({config.clock.utc_ns() - config.clock.monotonic_ns()}),
      refiner_(config.refine_in_thread) {
  server_.work_with(workers_);
  if (!config.map.empty()) {
    keeper_.emplace(config.map, config.server.map_file, &server_);
    if (server_.restored_until()) sync_.begin_after(server_.map().now());
    if (const auto date_ns = keeper_->date_now_ns()) stamps_.expect(*date_ns - config_.clock.monotonic_ns());
  }
  server_.keep_journal(!(config.out.empty() && config.runs.empty()) && config.server.events.enabled);
  if (config_.expected_agents.empty()) {
    started_ = true;
    stamps_.expect(-config_.clock.monotonic_ns());
  }
  send_status();
}

void ServerLoop::observe(ServerObserver* observer) {
  observer_ = observer;
  if (observer != nullptr) server_.keep_journal(true);
}

bool ServerLoop::poll(std::chrono::milliseconds timeout) {
  constexpr int kMostSets = 32;  // whoever stops the server is heard in between
  take_events(timeout);
  for (int i = 0; i < kMostSets; ++i) {
    const std::optional<FrameSet> set = next_set();
    if (!set) break;
    run_set(*set);
    take_events(std::chrono::milliseconds(0));
  }
  for (auto& [name, agent] : agents_) {
    if (agent.ended && !agent.said_images && agent.images.all_known()) say_images_of(name, agent);
  }
  if (!started_ || config_.expected_agents.empty() || !backlog_.empty()) return true;
  return !std::all_of(agents_.begin(), agents_.end(), [](const auto& a) { return a.second.ended; });
}

void ServerLoop::take_events(std::chrono::milliseconds timeout) {
  for (auto event = link_.next_event(backlog_.empty() ? timeout : std::chrono::milliseconds(0)); event;
       event = link_.next_event(std::chrono::milliseconds(0))) {
    handle(*event);
  }
  if (!store_) open_result();
  for (const std::string& warning : stamps_.take_warnings()) log_warn(warning);
  if (config_.expected_agents.empty()) order_play();
  const bool starting = started_ && config_.clock.utc_ns() - start_utc_ns_ < kStarting_ns;
  const TimeNs period_ns = starting ? kStartingPeriod_ns : kStatusPeriod_ns;
  if (config_.clock.monotonic_ns() - last_status_ns_ > period_ns) send_status();
  if (observer_ != nullptr) observer_->in_between(*this);
}

// By hand, that is without names to wait for.
void ServerLoop::order_play() {
  if (!play_order_.due(config_.clock.monotonic_ns())) return;
  start_utc_ns_ = config_.clock.utc_ns() + to_ns(kStartDelay_s);
  stamps_.expect(-(config_.clock.monotonic_ns() + to_ns(kStartDelay_s)));
  send_status();
}

// Not before the link is at work: a server that is refused for its domain touches nothing. A folder of the run's own
// waits for an agent besides, so that `latest` names a run that has something.
void ServerLoop::open_result() {
  if ((config_.out.empty() && config_.runs.empty()) || !link_.at_work()) return;
  if (config_.runs.empty()) {
    store_.emplace(result_ = config_.out, config_.server.events);
    return;
  }
  if (!std::exchange(runs_made_, true)) make_folder_of_runs(config_.runs);
  if (agents_.empty()) return;
  const std::filesystem::path folder = make_run_folder(config_.runs, config_.clock.utc_ns(), server_.run());
  store_.emplace(result_ = folder, config_.server.events);
  link_latest(folder);
  log_info("the result goes to " + folder.string());
}

std::optional<FrameSet> ServerLoop::next_set() {
  constexpr double kBacklog_s = 0.5;  // what a slow set and jitter heap up
  const TimeNs now_ns = config_.clock.monotonic_ns();
  if (lockstep_) return sync_.pop(now_ns);
  while (auto set = sync_.pop(now_ns)) backlog_.push(std::move(*set));
  const std::vector<FrameSet> left_out = backlog_.thin(std::max(2U, server_.map().sets_in(kBacklog_s)));
  for (const FrameSet& set : left_out) {
    for (const CameraFrame& f : set.frames) images_of(f.camera).set_left_out();
  }
  left_out_ += static_cast<std::uint32_t>(left_out.size());
  if (!left_out.empty() && left_out_log_.pass()) {
    log_warn("the server is too slow for its agents: " + std::to_string(left_out_) +
             " frame sets were left out so far");
  }
  return backlog_.pop();
}

void ServerLoop::handle(const ServerEvent& event) {
  if (const auto* hello = std::get_if<Hello>(&event)) on_hello(*hello);
  if (const auto* frame = std::get_if<JoinedFrame>(&event)) on_frame(*frame);
  if (const auto* status = std::get_if<AgentStatus>(&event)) on_status(*status);
  if (const auto* gone = std::get_if<AgentGone>(&event)) on_gone(gone->agent, gone->agent_run);
  if (const auto* silent = std::get_if<AgentSilent>(&event)) on_silent(silent->agent, silent->agent_run);
}

// Why an agent cannot take part; empty: it can.
std::optional<std::string> ServerLoop::why_not(const Hello& hello) const {
  const auto& expected = config_.expected_agents;
  if (!expected.empty() && std::find(expected.begin(), expected.end(), hello.agent) == expected.end())
    return "agent " + hello.agent + " is not one that this server waits for";
  if (agents_.size() >= kMostAgents && !agents_.contains(hello.agent)) {
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

void ServerLoop::on_hello(const Hello& hello) {
  if (const auto reason = why_not(hello)) return link_.refuse(hello, *reason);
  if (started_) {
    play_order_.joined(config_.clock.monotonic_ns());
    admit(hello);
    send_status();  // which a replay waits for
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
  start_utc_ns_ = config_.clock.utc_ns() + to_ns(kStartDelay_s);
  stamps_.expect(-(config_.clock.monotonic_ns() + to_ns(kStartDelay_s)));  // recordings begin at played time 0
  send_status();
}

void ServerLoop::admit(const Hello& hello) {
  const bool back = agents_.contains(hello.agent);
  Agent& agent = agents_[hello.agent];
  const bool another = agent.run != hello.agent_run;
  agent.camera = server_.admit(hello);
  const std::optional<SetId> since = server_.met_since(agent.camera);
  if (another) {
    agent.images.begin(server_.restored_until() && since && *since <= *server_.restored_until());
    agent.begun = false;
    agent.missed = 0;
  }
  if (keeper_ && !back) known_past_.push_back(agent.camera);
  agent.run = hello.agent_run;
  agent.pacing = hello.pacing;
  agent.ended = agent.said_images = false;
  server_.set_alive(agent.camera, true);
  const bool waits = hello.pacing == Pacing::kLockstep;
  lockstep_ |= waits;
  sync_.add(agent.camera, hello.rate_hz, waits);
  stamps_.add(agent.camera, hello.agent, hello.rate_hz);
  log_info("agent " + hello.agent + (back ? " is back" : " joined"));
}

// Of agents that have gone on since a server before this one: their result begins with what that one put down.
void ServerLoop::take_known_past() {
  for (const CameraId camera : std::exchange(known_past_, {})) {
    if (!server_.met_since(camera)) continue;
    keeper_->for_each_past(camera, [&](PastFrames block) {
      PastPart past;
      past.frames.push_back(std::move(block));
      store_->take(past);
    });
  }
}

ServerLoop::Agent* ServerLoop::find(const std::string& name, RunId run) {
  const auto at = agents_.find(name);
  return at == agents_.end() || at->second.run != run ? nullptr : &at->second;
}

void ServerLoop::on_frame(const JoinedFrame& joined) {
  Agent* agent = find(joined.frame.agent, joined.frame.agent_run);
  if (agent == nullptr) return;
  agent->images.arrived();
  if (joined.frame.capture_ns < kFirstDate_ns) play_order_.plays();
  CameraFrame frame{agent->camera, joined.frame, joined.patches, joined.descriptors};
  // A pose in the map of a server before this one says nothing here.
  if (frame.frame.server_run != server_.run()) frame.frame.pose_state = PoseState::kNone;
  const TimeNs now_ns = config_.clock.monotonic_ns();
  if (!lockstep_) {
    // What waited for its replies, for frames before it or for this loop was not under way.
    const TimeNs waited_ns =
        joined.arrived ? monotonic_now_ns() - std::chrono::nanoseconds(joined.arrived->time_since_epoch()).count() : 0;
    const auto taken_ns = stamps_.place(agent->camera, frame.frame.capture_ns, now_ns - waited_ns);
    if (!taken_ns) return agent->images.out_of_time();
    frame.frame.capture_ns = *taken_ns;
  }
  if (keeper_) keeper_->before_frame(frame.frame.capture_ns);
  const std::uint32_t overflowed = sync_.overflowed();
  const bool used = sync_.push(std::move(frame), now_ns);
  if (!used) agent->images.late();
  note_missed(joined.frame, !used, *agent);
  if (sync_.overflowed() > overflowed) agent->images.set_left_out();
  // A replay that joined late or began anew catches up with the others.
  if (!used && lockstep_) link_.send(server_.acknowledge(agent->camera, joined.frame));
}

// Of a recording whose agent joined when others played: in lock-step what it sends is late, in real time it begins with
// what is due then.
void ServerLoop::note_missed(const TrackFrame& frame, bool late, Agent& agent) const {
  constexpr TimeNs kInTheMiddle_ns = 1'000'000'000;
  if (agent.begun || frame.capture_ns >= kFirstDate_ns) return;
  if (late) {
    agent.missed = frame.frame.value + 1;
    agent.past_ns = sync_.past_ns().value_or(0);
  } else if (agent.missed == 0 && frame.capture_ns > kInTheMiddle_ns) {
    agent.missed = frame.frame.value;
    agent.past_ns = frame.capture_ns;
  }
  agent.begun |= !late;
}

void ServerLoop::on_status(const AgentStatus& status) {
  Agent* agent = find(status.agent, status.agent_run);
  if (agent == nullptr) return;
  if (status.image_fault != agent->last_status.image_fault) say_images(status);
  agent->last_status = status;
  agent->images.heard(status);
  auto last_image = std::exchange(agent->last_status.last_image, std::nullopt);
  if (status.exchange.sent_ns != 0) stamps_.exchange(agent->camera, status.exchange);
  if (status.state != AgentState::kFinished || agent->ended) return;
  if (last_image) server_.take_last_image(agent->camera, std::move(*last_image));
  log_info("agent " + status.agent + " has ended");
  end(*agent);
}

void ServerLoop::say_images(const AgentStatus& status) {
  if (status.image_fault == ImageFault::kNone) {
    log_info("agent " + status.agent + ": its images are to be believed again");
  } else {
    log_warn("agent " + status.agent +
             ": its images are not to be believed: " + std::string(words_of(status.image_fault).why));
  }
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
  for (MapPatch& patch : server_.step(set)) {
    if (!lockstep_) {
      patch.sent_ns = config_.clock.monotonic_ns();
      patch.uplink_wait_s = static_cast<float>(stamps_.wait_s(agents_[patch.agent].camera));
    }
    link_.send(patch);
  }
  count_used(set);
  const PastPart past = server_.take_past();
  for (const MovingState& state : server_.moving()) link_.send(state);
  const auto in_metres = [&](MapId map) { return server_.scale_known(map); };
  for (const AgentPose& pose : agent_poses(server_.map(), set, server_.run(), in_metres)) link_.send(pose);
  for (const std::string& warning : server_.take_warnings()) log_warn(warning);
  if (auto job = server_.take_refine_job()) refiner_.start(std::move(*job), set.id);
  if (store_) {
    if (!known_past_.empty()) take_known_past();
    store_->take(past);
    store_->record(set, server_);
  }
  if (keeper_) {
    keeper_->take(past);
    keeper_->after_set();
  }
  if (observer_ != nullptr) observer_->after_set(set, *this);
}

void ServerLoop::count_used(const FrameSet& set) {
  for (const CameraFrame& f : set.frames) {
    const FramePose* pose = server_.map().camera(f.camera).frame_at(set.id);
    Agent& agent = agents_.at(server_.map().camera(f.camera).name);
    agent.images.used(pose != nullptr && pose->valid());
    if (agent.images.frames_posed() == 0) agent.seen.look(server_.map().camera(f.camera));
  }
}

void ServerLoop::give_refined(std::optional<RefineSolution> solution) {
  if (solution) server_.give_refined(std::move(solution->job), std::move(solution->result), solution->took);
}

void ServerLoop::send_status() {
  last_status_ns_ = config_.clock.monotonic_ns();
  ServerStatus status;
  status.server_run = server_.run();
  status.started = started_ && (!config_.expected_agents.empty() || play_order_.ordered());
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
  for (const auto& [name, agent] : agents_) {
    if (!agent.ended) link_.send({name, agent.run, server_.run(), agent.images.so_far(), false, {}});
  }
}

void ServerLoop::report_now(bool adjusted, const nlohmann::ordered_json& configuration) {
  report_ = make_report(server_, link_, {sync_.late(), sync_.overflowed(), left_out_, stamps_}, agents(), adjusted,
                        configuration);
}

// False: not all of it. There may be room when it is written again.
bool ServerLoop::write_first(bool adjusts) {
  if (!store_ && !keeper_) return true;
  bool written = true;
  const auto attempt = [&](const auto& write) {
    try {
      write();
    } catch (const UserError& e) {
      log_warn(e.what());
      written = false;
    }
  };
  if (store_) attempt([&] { store_->write(server_, report_); });
  if (keeper_) attempt([&] { keeper_->finish(); });
  if (written && adjusts) log_info("the result is written; adjusting the map, which Ctrl-C leaves out");
  return written;
}

void ServerLoop::finish(const nlohmann::ordered_json& configuration, bool short_end) {
  const RefineConfig& refine = config_.server.map.of<RefineConfig>();
  const bool adjusts = !short_end && refine.enabled && refine.at_end != "nothing";
  while (const auto set = backlog_.pop()) run_set(*set);
  report_now(false, configuration);
  const bool written = write_first(adjusts);
  stopping_ = true;
  send_status();
  if (observer_ != nullptr) observer_->finishing(*this);
  if (!short_end) {
    const EndsAtOnce at_a_signal(written ? 0 : 1);
    give_refined(refiner_.take(true));
    server_.finish(config_.adjusting);
  } else {
    log_info("stopped in a hurry: the map is not adjusted as a whole");
    if (written) return;
  }
  for (const std::string& warning : server_.take_warnings()) log_warn(warning);
  report_now(adjusts, configuration);
  if (observer_ != nullptr) observer_->finished(*this);
  if (store_) store_->finish(server_, report_);
  if (keeper_) keeper_->finish();
}

}  // namespace coslam
