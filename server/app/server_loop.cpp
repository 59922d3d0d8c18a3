// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/server_loop.h"

#include <algorithm>
#include <utility>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/words.h"
#include "server/app/answers.h"
#include "server/app/collect_facts.h"
#include "server/app/stop_signals.h"

namespace coslam {
namespace {

constexpr TimeNs kStatusPeriod_ns = 1'000'000'000;
// Around the start: by the word that took least, agents tell what their clocks are off by.
constexpr TimeNs kStartingPeriod_ns = 100'000'000, kStarting_ns = 1'000'000'000;
constexpr double kStartDelay_s = 0.3;  // between the word to start and played time 0

}  // namespace

ServerLoop::ServerLoop(ServerLink& link, RunId run, const ServerLoopConfig& config)
    : link_(link),
      config_(config),
      workers_("map helper", threads_of(config.server)),
      server_(run, config.server.map),
      sets_(config.server.sync, config.clock.utc_ns() - config.clock.monotonic_ns()),
      roster_(config.expected_agents),
      refiner_(config.refine_in_thread) {
  server_.work_with(workers_);
  server_.keep_journal(false);
  if (!config.map.empty()) {
    keeper_.emplace(config.map, config.server.map_file, &server_);
    if (server_.restored_until()) sets_.begin_after(server_.map().now());
    if (const auto date_ns = keeper_->date_now_ns()) sets_.expect(*date_ns - config_.clock.monotonic_ns());
  }
  if (!config.result.none()) {
    observe(
        recorder_.emplace(config.result, config.server.events, config_.clock.utc_ns, keeper_ ? &*keeper_ : nullptr));
  }
  if (keeper_) observe(*keeper_);
  if (roster_.expected().empty()) {
    started_ = true;
    sets_.expect(-config_.clock.monotonic_ns());
  }
  send_status();
}

void ServerLoop::observe(SetObserver& observer) {
  observers_.add(observer);
  server_.keep_journal(server_.journal().enabled() || observer.wants_journal());
}

ServerView ServerLoop::view() const {
  return {server_, link_.at_work(), roster_.agents().size(), [this] { return facts(); }};
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
  for (const auto& [name, agent] : roster_.agents()) {
    if (agent.ended && !agent.said_images && agent.images.all_known()) say_images_of(name, roster_.at(name));
  }
  if (!started_ || roster_.expected().empty() || sets_.waiting()) return true;
  return !roster_.all_ended();
}

void ServerLoop::take_events(std::chrono::milliseconds timeout) {
  for (auto event = link_.next_event(sets_.waiting() ? std::chrono::milliseconds(0) : timeout); event;
       event = link_.next_event(std::chrono::milliseconds(0))) {
    handle(*event);
  }
  for (const std::string& warning : sets_.take_warnings()) log_warn(warning);
  if (roster_.expected().empty() && play_order_.due(config_.clock.monotonic_ns())) order_start();
  const bool starting = started_ && config_.clock.utc_ns() - start_utc_ns_ < kStarting_ns;
  const TimeNs period_ns = starting ? kStartingPeriod_ns : kStatusPeriod_ns;
  if (config_.clock.monotonic_ns() - last_status_ns_ > period_ns) send_status();
  observers_.idle(view());
}

// Recordings begin at played time 0.
void ServerLoop::order_start() {
  start_utc_ns_ = config_.clock.utc_ns() + to_ns(kStartDelay_s);
  sets_.expect(-(config_.clock.monotonic_ns() + to_ns(kStartDelay_s)));
  send_status();
}

std::optional<FrameSet> ServerLoop::next_set() {
  constexpr double kBacklog_s = 0.5;  // what a slow set and jitter heap up
  const std::uint32_t before = sets_.sets_left_out();
  auto set = sets_.next(config_.clock.monotonic_ns(), std::max(2U, server_.map().sets_in(kBacklog_s)),
                        [&](const FrameSet& left_out) {
                          for (const CameraFrame& f : left_out.frames) {
                            roster_.at(server_.map().camera(f.camera).name).images.set_left_out();
                          }
                        });
  if (sets_.sets_left_out() > before && left_out_log_.pass()) {
    log_warn("the server is too slow for its agents: " + std::to_string(sets_.sets_left_out()) +
             " frame sets were left out so far");
  }
  return set;
}

void ServerLoop::handle(const ServerEvent& event) {
  if (const auto* hello = std::get_if<Hello>(&event)) on_hello(*hello);
  if (const auto* frame = std::get_if<JoinedFrame>(&event)) on_frame(*frame);
  if (const auto* status = std::get_if<AgentStatus>(&event)) on_status(*status);
  if (const auto* agent_gone = std::get_if<AgentGone>(&event)) on_gone(agent_gone->agent, agent_gone->agent_run);
  if (const auto* silent = std::get_if<AgentSilent>(&event)) on_silent(silent->agent, silent->agent_run);
}

void ServerLoop::on_hello(const Hello& hello) {
  if (const auto reason = roster_.why_not(hello)) return link_.refuse(hello, *reason);
  if (started_) {
    play_order_.joined(config_.clock.monotonic_ns());
    admit(hello);
    send_status();  // which a replay waits for
    return;
  }
  roster_.wait(hello);
  start_if_complete();
}

void ServerLoop::start_if_complete() {
  const std::vector<Hello> all = roster_.take_complete();
  if (all.empty()) return;
  for (const Hello& hello : all) admit(hello);
  started_ = true;
  order_start();
}

void ServerLoop::admit(const Hello& hello) {
  const bool back = roster_.knows(hello.agent);
  const CameraId camera = server_.admit(hello);
  const std::optional<SetId> first_met = server_.met_since(camera);
  roster_.admit(hello, camera, server_.restored_until() && first_met && *first_met <= *server_.restored_until());
  server_.set_alive(camera, true);
  sets_.add(camera, hello);
  log_info("agent " + hello.agent + (back ? " is back" : " joined"));
}

void ServerLoop::on_frame(const JoinedFrame& joined) {
  Roster::Agent* agent = roster_.find(joined.frame.agent, joined.frame.agent_run);
  if (agent == nullptr) return;
  agent->images.arrived();
  if (joined.frame.capture_ns < kFirstDate_ns) play_order_.plays();
  CameraFrame frame{agent->camera, joined.frame, joined.patches, joined.descriptors};
  // A pose in the map of a server before this one says nothing here.
  if (frame.frame.server_run != server_.run()) frame.frame.pose_state = PoseState::kNone;
  const TimeNs now_ns = config_.clock.monotonic_ns();
  // What waited for its replies, for frames before it or for this loop was not under way.
  const TimeNs waited_ns =
      joined.arrived ? monotonic_now_ns() - std::chrono::nanoseconds(joined.arrived->time_since_epoch()).count() : 0;
  if (!sets_.date(&frame, now_ns - waited_ns)) return agent->images.out_of_time();
  if (keeper_) keeper_->before_frame(frame.frame.capture_ns);
  const SetClock::Pushed pushed = sets_.push(std::move(frame), now_ns);
  if (!pushed.in_time) agent->images.late();
  Roster::note_missed(joined.frame, !pushed.in_time, sets_.past_ns(), agent);
  if (pushed.displaced) agent->images.set_left_out();
  // A replay that joined late or began anew catches up with the others.
  if (!pushed.in_time && sets_.lockstep()) link_.send(server_.acknowledge(agent->camera, joined.frame));
}

void ServerLoop::on_status(const AgentStatus& status) {
  Roster::Agent* agent = roster_.find(status.agent, status.agent_run);
  if (agent == nullptr) return;
  if (status.image_fault != agent->last_status.image_fault) log_images(status);
  agent->last_status = status;
  agent->images.heard(status);
  auto last_image = std::exchange(agent->last_status.last_image, std::nullopt);
  if (status.exchange.sent_ns != 0) sets_.exchange(agent->camera, status.exchange);
  if (status.state != AgentState::kFinished || agent->ended) return;
  if (last_image) server_.take_last_image(agent->camera, *last_image);
  log_info("agent " + status.agent + " has ended");
  end(*agent);
}

void ServerLoop::on_silent(const std::string& name, RunId run) {
  const Roster::Agent* agent = roster_.find(name, run);
  // In lock-step a slow agent is waited for; one that died is reported gone.
  if (agent == nullptr || sets_.lockstep()) return;
  log_warn("agent " + name + " is silent");
  sets_.set_silent(agent->camera);
}

void ServerLoop::on_gone(const std::string& name, RunId run) {
  roster_.stop_waiting(name);
  Roster::Agent* agent = roster_.find(name, run);
  if (agent == nullptr || agent->ended) return;
  log_warn("agent " + name + " is gone; the others go on");
  end(*agent);
}

void ServerLoop::end(Roster::Agent& agent) {
  agent.ended = true;
  sets_.finish(agent.camera);
  server_.set_alive(agent.camera, false);
}

void ServerLoop::run_set(const FrameSet& set) {
  give_refined(refiner_.take_due(set.id, sets_.lockstep()));
  send_answers(set, server_.step(set), server_, roster_, sets_, config_.clock.monotonic_ns, &link_);
  roster_.count_used(set, server_.map());
  const PastPart past = server_.take_past();
  for (const std::string& warning : server_.take_warnings()) log_warn(warning);
  if (auto job = server_.take_refine_job()) refiner_.start(std::move(*job), set.id);
  observers_.after_set({set, past}, view());
}

void ServerLoop::give_refined(std::optional<RefineSolution> solution) {
  if (solution) server_.give_refined(std::move(solution->job), std::move(solution->result), solution->took);
}

void ServerLoop::send_status() {
  last_status_ns_ = config_.clock.monotonic_ns();
  ServerStatus status = status_of(server_, roster_);
  status.started = started_ && (!roster_.expected().empty() || play_order_.ordered());
  status.stopping = stopping_;
  status.start_utc_ns = start_utc_ns_;
  link_.send_status(status);
  for (const auto& [name, agent] : roster_.agents()) {
    if (!agent.ended) link_.send(AgentImages{name, agent.run, server_.run(), agent.images.so_far(), false, {}});
  }
}

// To the agent and in the log, when it has ended and the fate of all is known; of agents that were named the report
// tells it.
void ServerLoop::say_images_of(const std::string& name, Roster::Agent& agent) {
  agent.said_images = true;
  const ImageAccount images = agent.images.so_far();
  const std::string problem = roster_.expected().empty() ? Roster::problem_of(name, agent, images) : "";
  if (!problem.empty()) log_warn(problem);
  link_.send(AgentImages{name, agent.run, server_.run(), images, true, problem});
}

void ServerLoop::report_now(bool adjusted, const nlohmann::ordered_json& configuration) {
  report_ = make_report(server_, link_, {sets_.late(), sets_.overflowed(), sets_.sets_left_out(), sets_.stamps()},
                        agents(), adjusted, configuration);
}

// False: not all of it. There may be room when it is written again.
bool ServerLoop::write_first(bool adjusts) {
  const std::vector<std::string> problems = observers_.ending(view(), report_);
  for (const std::string& problem : problems) log_warn(problem);
  const bool kept = keeper_ || (recorder_ && !recorder_->folder().empty());
  if (kept && problems.empty() && adjusts) {
    log_info("the result is written; adjusting the map, which Ctrl-C leaves out");
  }
  return problems.empty();
}

void ServerLoop::finish(const nlohmann::ordered_json& configuration, bool short_end) {
  const BundleAdjustmentConfig& refine = config_.server.map.of<BundleAdjustmentConfig>();
  const bool adjusts = !short_end && refine.enabled && refine.at_end != "nothing";
  while (const auto set = sets_.next_waiting()) run_set(*set);
  stopping_ = true;
  report_now(false, configuration);
  const bool written = write_first(adjusts);
  send_status();
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
  const std::vector<std::string> problems = observers_.ended(view(), report_);
  if (!problems.empty()) throw UserError(joined(problems, "; "));
}

std::string ServerLoop::problem() const {
  const auto problem = report_.find("problem");
  if (!roster_.all_ended()) return "";
  return problem == report_.end() ? "" : problem->get<std::string>();
}

LoopFacts ServerLoop::facts() const {
  LoopFacts out = collect_facts(roster_, sets_, link_, server_, stopping_);
  if (recorder_) out.result = recorder_->folder().string();
  return out;
}

}  // namespace coslam
