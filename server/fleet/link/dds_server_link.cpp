// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/link/dds_server_link.h"

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/flow/bounded_queue.h"
#include "common/wire/membership.h"
#include "server/fleet/link/server_ends.h"
#include "server/fleet/link/sessions.h"
#include "server/fleet/link/settling.h"
#include "server/fleet/link/speakers.h"

namespace coslam {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds kTick{20};
constexpr std::size_t kQueueCapacity = 256;  // 0.7 s of twelve agents at 30 Hz
constexpr const char* kName = "coslam-server";

using Ends = ServerEnds;

class DdsServerLink : public ServerLink {
 public:
  DdsServerLink(const WireConfig& config, RunId server_run, const AddressWatch::Addresses& addresses)
      : config_(config),
        server_run_(server_run),
        next_heartbeat_(Clock::now()),
        heartbeat_(to_milliseconds(config.silent_after_s / 4)),
        sessions_(to_milliseconds(2 * config.silent_after_s), *rejections_),
        events_(kQueueCapacity, QueuePolicy::kDropOldest,
                [](const ServerEvent& e) { return std::holds_alternative<JoinedFrame>(e); }),
        settling_(config, server_run, next_heartbeat_),
        status_{.server_run = server_run},
        membership_({.open = [this] { return open(); },
                     .leaving = [this](const Ends& e) { leave(e); },
                     .left = [this] { await_runs(); },
                     .joined_anew = [this](Ends& e) { greet(e); }},
                    addresses) {}

  std::optional<ServerEvent> next_event(milliseconds timeout) override {
    auto event = events_.pop_for(timeout);
    if (!event && events_.closed()) {
      throw UserError("another map server is at work in DDS domain " + std::to_string(config_.domain) +
                      ": stop it, or choose another domain; coslam doctor says where it is");
    }
    return event;
  }

  bool at_work() const override {
    const std::lock_guard lock(mutex_);
    return settling_.settled();
  }

  std::string join_options() const override {
    const bool loopback = config_.interfaces == loopback_config(config_.domain).interfaces;
    return "--domain " + std::to_string(config_.domain) + (loopback ? " --loopback" : "");
  }

  void send(const ServerMessage& message) override {
    message.visit([this](const auto& value) { write(value); });
  }

  std::optional<Thumbnail> thumbnail(const std::string& agent) override {
    const auto ends = membership_.ends();
    const std::lock_guard lock(mutex_);
    const Instant now = Clock::now();
    const auto run = sessions_.look(agent, now);
    if (run && ends) write_to_run(*ends, *run, encode(ThumbnailRequest{agent, *run, server_run_}));
    return sessions_.thumbnail(agent, now);
  }

  bool public_wanted() const override {
    const auto ends = membership_.ends();
    return ends && ends->all.writer<idl::PublicSample>().readers() > 0;
  }

  void send_status(const ServerStatus& status) override {
    const auto ends = membership_.ends();
    const std::lock_guard lock(mutex_);
    status_ = status;
    if (ends) publish_status(*ends);
  }

  void refuse(const Hello& hello, const std::string& reason) override {
    const auto ends = membership_.ends();
    const std::lock_guard lock(mutex_);
    sessions_.refuse(hello, reason);
    if (ends) after_change(*ends);
  }

  LinkBytes bytes(const std::string& agent) const override {
    const std::lock_guard lock(mutex_);
    return sessions_.bytes(agent);
  }

  ServerLinkCounts counts() const override {
    const std::lock_guard lock(mutex_);
    return {events_.counts().dropped, sessions_.late_replies(), resent_};
  }

  const RejectionCounts& rejections() const override { return *rejections_; }

 private:
  std::unique_ptr<Ends> open() {
    WireConfig config = config_;
    config.also_call = also_call_;
    auto ends = std::make_unique<Ends>(config, kName, rejections_, kTick, [this](Ends& e) { tick(e); });
    for_each_message_type([&]<class M, class S, class V>(const MessageType<M, S, V>&) {
      if constexpr (goes_up(topic_of<M>())) read<M>(*ends);
    });
    ends->loop.read<idl::ServerStatus>([this](const idl::ServerStatus& m, const Sample&) { look_for_rival(m); });
    ends->loop.start();
    return ends;
  }

  // Agents that were told where to call this server would go on calling its old address: it calls them.
  void leave(const Ends& ends) { also_call_ = ends.participant.addresses_of_others(); }

  // Runs that are not heard again in time are gone.
  void await_runs() {
    const std::lock_guard lock(mutex_);
    speakers_ = {};
    const Instant until = Clock::now() + to_milliseconds(config_.lease_s);
    for (const RunId run : sessions_.runs()) {
      sessions_.presence(run, Presence::kSilent);
      unheard_until_[run] = until;
    }
  }

  void greet(Ends& ends) {
    const std::lock_guard lock(mutex_);
    publish_status(ends);
  }

  // A patch is kept: it is written again to a run that asks for it, and when this server has joined anew.
  void write(const MapPatch& patch) {
    idl::MapPatch message = encode(patch);
    const auto ends = membership_.ends();
    const std::lock_guard lock(mutex_);
    if (!sessions_.knows(patch.agent_run)) return;
    last_[patch.agent_run] = std::move(message);
    if (ends) write_last(*ends, patch.agent_run);
  }
  template <class Value>
  void write(const Value& value) {
    using Message = decltype(encode(value));
    const auto ends = membership_.ends();
    if (!ends) return;
    if constexpr (goes_to_run(topic_of<Message>())) {
      const std::lock_guard lock(mutex_);
      write_to_run(*ends, value.agent_run, encode(value));
    } else {
      auto& writer = ends->all.template writer<Message>();
      if (writer.readers() > 0) writer.write(encode(value));
    }
  }

  template <class Message>
  void write_to_run(Ends& ends, RunId run, const Message& message) {
    const auto way = ends.runs.find(run);
    if (way != ends.runs.end()) sessions_.count_down(run, way->second.template writer<Message>().write(message));
  }
  void write_last(Ends& ends, RunId run) { write_to_run(ends, run, last_.at(run)); }

  void publish_status(Ends& ends) {
    if (!settling_.settled()) return;
    ServerStatus status = status_;
    status.refused = sessions_.refused();
    published_refusals_ = status.refused.empty() ? RunId() : status.refused.back().agent_run;
    sessions_.count_down_all(ends.status.write(encode(status)));
  }

  // On the loop's thread from here on, all under the mutex.
  template <class Message>
  void read(Ends& ends) {
    constexpr bool kSignOfLife = topic_of<Message>().sign_of_life;
    Loop::OnPresence on_presence;
    if (kSignOfLife) on_presence = [this, &ends](const WriterId& w, Presence p) { presence(ends, w, p); };
    ends.loop.read<Message>(
        [this, &ends](const Message& message, const Sample& sample) {
          const std::lock_guard lock(mutex_);
          const RunId run(message.agent_run());
          if (!speakers_.may_say(run, sample.writer, kSignOfLife)) return rejections_->add(Rejection::kWrongRun);
          unheard_until_.erase(run);
          sessions_.receive(message, sample.bytes, Clock::now());
          after_change(ends);
        },
        on_presence);
  }

  void presence(Ends& ends, const WriterId& writer, Presence presence) {
    const std::lock_guard lock(mutex_);
    const auto run = speakers_.run_of(writer);  // of hellos, whose writers are the agents' signs of life
    if (!run) return;
    sessions_.presence(*run, presence);
    if (presence == Presence::kGone) speakers_.note_gone(writer);
    after_change(ends);
  }

  void look_for_rival(const idl::ServerStatus& message) {
    if (message.server_run() == server_run_.value) return;
    const std::lock_guard lock(mutex_);
    if (settling_.yields_to_rival()) events_.close();
  }

  static bool is_alone(const Ends& ends) { return std::ranges::count(ends.participant.others(), kName) == 0; }

  void tick(Ends& ends) {
    const std::lock_guard lock(mutex_);
    const Instant now = Clock::now();
    if (!settling_.settled() && settling_.settle(is_alone(ends), now)) publish_status(ends);
    if (settling_.settled() && now >= next_heartbeat_) {
      next_heartbeat_ = now + heartbeat_;
      ends.status.assert_alive();
    }
    std::erase_if(unheard_until_, [&](const auto& run) {
      if (now < run.second) return false;
      sessions_.presence(run.first, Presence::kGone);
      return true;
    });
    sessions_.tick(now);
    after_change(ends);
  }

  void after_change(Ends& ends) {
    open_ways(ends);
    const auto unknown = [this](const auto& of_run) { return !sessions_.knows(of_run.first); };
    std::erase_if(ends.runs, unknown);
    std::erase_if(last_, unknown);
    answer_repeated(ends);
    for (ServerEvent& event : sessions_.take_events()) events_.push(std::move(event));
    const std::vector<Refusal>& refused = sessions_.refused();
    if (!refused.empty() && refused.back().agent_run != published_refusals_) publish_status(ends);
  }

  // A run is let in when its reader has found our writer, since a patch sent before would be lost, and when it says
  // that it has found all that it hears and is heard by: play starts then.
  void open_ways(Ends& ends) {
    if (!settling_.settled()) return;
    for (const RunId run : sessions_.runs()) ends.runs.try_emplace(run, ends.participant, partition_of(run));
    for (const RunId run : sessions_.waiting()) {
      const bool is_found = ends.runs.at(run).writer<idl::MapPatch>().readers() > 0;
      if (is_found && sessions_.said_ready(run)) sessions_.open(run);
    }
  }

  // A frame that was answered came again: the answer may have been lost while the link was cut.
  void answer_repeated(Ends& ends) {
    for (const auto& [run, frame] : sessions_.take_repeated()) {
      const auto last = last_.find(run);
      if (last == last_.end()) continue;
      if (FrameId(last->second.after_frame()) < frame) continue;  // not answered yet: the map thread is at it
      write_last(ends, run);
      ++resent_;
    }
  }

  const WireConfig config_;
  const RunId server_run_;
  Instant next_heartbeat_;
  const milliseconds heartbeat_;
  const std::shared_ptr<RejectionCounts> rejections_ = std::make_shared<RejectionCounts>();

  mutable std::mutex mutex_;  // for all below but the queue
  Sessions sessions_;
  BoundedQueue<ServerEvent> events_;
  Settling settling_;
  std::map<RunId, idl::MapPatch> last_;     // to each run
  std::map<RunId, Instant> unheard_until_;  // runs of which nothing was heard since this server joined anew
  Speakers speakers_;
  ServerStatus status_;
  RunId published_refusals_;  // the newest that agents were told of
  std::uint64_t resent_ = 0;

  std::vector<std::string> also_call_;  // of the thread that joins anew
  Membership<Ends> membership_;         // last: stops first; its lock comes before the mutex
};

}  // namespace

std::unique_ptr<ServerLink> open_server_link(const WireConfig& config, RunId server_run,
                                             const AddressWatch::Addresses& addresses) {
  return std::make_unique<DdsServerLink>(config, server_run, addresses);
}

}  // namespace coslam
