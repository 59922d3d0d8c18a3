// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/link/dds_server_link.h"

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/flow/bounded_queue.h"
#include "common/wire/loop.h"
#include "common/wire/participant.h"
#include "server/fleet/link/sessions.h"
#include "server/fleet/link/speakers.h"

namespace coslam {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds kTick{20};
constexpr std::size_t kQueueCapacity = 256;  // 0.7 s of twelve agents at 30 Hz

milliseconds in_ms(double seconds) { return milliseconds(std::lround(1000 * seconds)); }

constexpr const char* kName = "coslam-server";

// How long a new server says nothing, to hear of one that was here before. That there is another one is known soon;
// what it says, and whether it just starts too, may take longer. The time differs between servers that start together,
// so that one of them speaks first.
milliseconds settling_time(const WireConfig& config, RunId run, bool alone) {
  return alone ? in_ms(1.2 * config.announce_s) : in_ms(5 * config.announce_s) + milliseconds(run.value % 1024);
}

// What the link has in the domain.
struct Ends {
  Participant participant;
  Writer<idl::ServerStatus> status{participant};
  Writer<idl::MovingState> moving{participant};
  Writer<idl::AgentPose> pose{participant};
  Writer<idl::PublicSample> for_all{participant};
  // Back to a run: writers in its partition.
  struct WayBack {
    Writer<idl::MapPatch> patches;
    Writer<idl::AgentImages> images;
    Writer<idl::ThumbnailRequest> thumbnails;
    WayBack(Participant& participant, const std::string& partition)
        : patches(participant, partition), images(participant, partition), thumbnails(participant, partition) {}
  };
  std::map<RunId, WayBack> ways;
  Loop loop;  // last: stops first

  Ends(const WireConfig& config, std::shared_ptr<RejectionCounts> rejections, const std::function<void(Ends&)>& on_tick)
      : participant(config, kName, std::move(rejections)),
        loop(participant, "server-link", kTick, [this, on_tick] { on_tick(*this); }) {}
};

class DdsServerLink : public ServerLink {
 public:
  DdsServerLink(const WireConfig& config, RunId server_run, const AddressWatch::Addresses& addresses)
      : config_(config),
        server_run_(server_run),
        opened_at_(Clock::now()),
        next_heartbeat_(opened_at_),
        heartbeat_(in_ms(config.silent_after_s / 4)),
        sessions_(in_ms(2 * config.silent_after_s), *rejections_),
        events_(kQueueCapacity, QueuePolicy::kDropOldest,
                [](const ServerEvent& e) { return std::holds_alternative<JoinedFrame>(e); }) {
    status_.server_run = server_run;
    ends_ = open({});
    addresses_.emplace(addresses, [this] { return join_anew(); });
  }

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
    return settled_;
  }

  std::string join_options() const override {
    const bool loopback = config_.interfaces == loopback_config(config_.domain).interfaces;
    return "--domain " + std::to_string(config_.domain) + (loopback ? " --loopback" : "");
  }

  void send(const MapPatch& patch) override {
    idl::MapPatch message = encode(patch);
    const std::shared_lock ends_lock(ends_mutex_);
    const std::lock_guard lock(mutex_);
    if (!sessions_.knows(patch.agent_run)) return;
    last_[patch.agent_run] = std::move(message);
    if (ends_) write_last(*ends_, patch.agent_run);
  }

  void send(const MovingState& state) override {
    const std::shared_lock lock(ends_mutex_);
    if (ends_ && ends_->moving.readers() > 0) ends_->moving.write(encode(state));
  }

  void send(const AgentPose& pose) override {
    const std::shared_lock lock(ends_mutex_);
    if (ends_ && ends_->pose.readers() > 0) ends_->pose.write(encode(pose));
  }

  void send(const AgentImages& images) override {
    const std::shared_lock ends_lock(ends_mutex_);
    const std::lock_guard lock(mutex_);
    if (!ends_) return;
    const auto way = ends_->ways.find(images.agent_run);
    if (way != ends_->ways.end()) sessions_.count_down(images.agent_run, way->second.images.write(encode(images)));
  }

  std::optional<Thumbnail> thumbnail(const std::string& agent) override {
    const std::shared_lock ends_lock(ends_mutex_);
    const std::lock_guard lock(mutex_);
    const Instant now = Clock::now();
    if (const auto run = sessions_.look(agent, now); run && ends_) {
      const auto way = ends_->ways.find(*run);
      if (way != ends_->ways.end()) {
        sessions_.count_down(*run, way->second.thumbnails.write(encode(ThumbnailRequest{agent, *run, server_run_})));
      }
    }
    return sessions_.thumbnail(agent, now);
  }

  bool public_wanted() const override {
    const std::shared_lock lock(ends_mutex_);
    return ends_ && ends_->for_all.readers() > 0;
  }

  void send_public(const PublicSample& sample) override {
    const std::shared_lock lock(ends_mutex_);
    if (ends_ && ends_->for_all.readers() > 0) ends_->for_all.write(encode(sample));
  }

  void send_status(const ServerStatus& status) override {
    const std::shared_lock ends_lock(ends_mutex_);
    const std::lock_guard lock(mutex_);
    status_ = status;
    if (ends_) publish_status(*ends_);
  }

  void refuse(const Hello& hello, const std::string& reason) override {
    const std::shared_lock ends_lock(ends_mutex_);
    const std::lock_guard lock(mutex_);
    sessions_.refuse(hello, reason);
    if (ends_) after_change(*ends_);
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
  std::unique_ptr<Ends> open(std::vector<std::string> also_call) {
    WireConfig config = config_;
    config.also_call = std::move(also_call);
    auto ends = std::make_unique<Ends>(config, rejections_, [this](Ends& e) { tick(e); });
    for_each_message_type([&]<class M, class S, class V>(const MessageType<M, S, V>&) {
      if constexpr (topic_of<M>().way == Way::kUp) read<M>(*ends);
    });
    ends->loop.read<idl::ServerStatus>([this](const idl::ServerStatus& m, const Sample&) { look_for_rival(m); });
    ends->loop.start();
    return ends;
  }

  // Agents that were told where to call this server would go on calling its old address: it calls them.
  bool join_anew() {
    std::unique_ptr<Ends> before;
    {
      const std::unique_lock lock(ends_mutex_);
      before = std::move(ends_);
    }
    if (before) {
      log_info("this machine's addresses changed: joining DDS domain " + std::to_string(config_.domain) + " anew");
      also_call_ = before->participant.addresses_of_others();
      before->participant.give_up();
      before.reset();
      const std::lock_guard lock(mutex_);
      speakers_ = {};
      const Instant until = Clock::now() + in_ms(config_.lease_s);
      for (const RunId run : sessions_.runs()) {
        sessions_.presence(run, Presence::kSilent);
        unheard_until_[run] = until;
      }
    }
    try {
      auto fresh = open(also_call_);
      const std::unique_lock lock(ends_mutex_);
      ends_ = std::move(fresh);
    } catch (const UserError& error) {
      if (cannot_join_.pass()) log_warn(error.what());
      return false;
    }
    const std::shared_lock ends_lock(ends_mutex_);
    const std::lock_guard lock(mutex_);
    publish_status(*ends_);
    return true;
  }

  void write_last(Ends& ends, RunId run) {
    const auto way = ends.ways.find(run);
    if (way != ends.ways.end()) sessions_.count_down(run, way->second.patches.write(last_.at(run)));
  }

  void publish_status(Ends& ends) {
    if (!settled_) return;
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
    if (!settled_) {
      events_.close();
    } else if (rival_log_.pass()) {
      log_error("another map server is at work in this DDS domain: agents follow the newer one; stop one of them");
    }
  }

  bool may_settle(const Ends& ends, Instant now) const {
    const bool alone = std::ranges::count(ends.participant.others(), kName) == 0;
    return !events_.closed() && now - opened_at_ >= settling_time(config_, server_run_, alone);
  }

  void tick(Ends& ends) {
    const std::lock_guard lock(mutex_);
    const Instant now = Clock::now();
    if (!settled_ && may_settle(ends, now)) {
      settled_ = true;
      publish_status(ends);
    }
    if (settled_ && now >= next_heartbeat_) {
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
    std::erase_if(ends.ways, unknown);
    std::erase_if(last_, unknown);
    answer_repeated(ends);
    for (ServerEvent& event : sessions_.take_events()) events_.push(std::move(event));
    const std::vector<Refusal>& refused = sessions_.refused();
    if (!refused.empty() && refused.back().agent_run != published_refusals_) publish_status(ends);
  }

  // A run is let in when its reader has found our writer, since a patch sent before would be lost, and when it says
  // that it has found all that it hears and is heard by: play starts then.
  void open_ways(Ends& ends) {
    if (!settled_) return;
    for (const RunId run : sessions_.runs()) ends.ways.try_emplace(run, ends.participant, partition_of(run));
    for (const RunId run : sessions_.waiting()) {
      if (ends.ways.at(run).patches.readers() > 0 && sessions_.said_ready(run)) sessions_.open(run);
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
  const Instant opened_at_;
  Instant next_heartbeat_;
  const milliseconds heartbeat_;
  const std::shared_ptr<RejectionCounts> rejections_ = std::make_shared<RejectionCounts>();

  mutable std::mutex mutex_;  // for all below but the queue
  Sessions sessions_;
  BoundedQueue<ServerEvent> events_;
  std::map<RunId, idl::MapPatch> last_;     // to each run
  std::map<RunId, Instant> unheard_until_;  // runs of which nothing was heard since this server joined anew
  Speakers speakers_;
  ServerStatus status_;
  RunId published_refusals_;  // the newest that agents were told of
  std::uint64_t resent_ = 0;
  bool settled_ = false;
  LogLimiter rival_log_;

  mutable std::shared_mutex ends_mutex_;  // before the other mutex; held for a write at most
  std::unique_ptr<Ends> ends_;            // none while it joins anew
  std::vector<std::string> also_call_;    // of the thread that joins anew
  LogLimiter cannot_join_;
  std::optional<AddressWatch> addresses_;  // last: stops first
};

}  // namespace

std::unique_ptr<ServerLink> open_server_link(const WireConfig& config, RunId server_run,
                                             const AddressWatch::Addresses& addresses) {
  return std::make_unique<DdsServerLink>(config, server_run, addresses);
}

}  // namespace coslam
