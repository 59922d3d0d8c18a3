// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/link/dds_server_link.h"

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/flow/bounded_queue.h"
#include "common/wire/loop.h"
#include "common/wire/participant.h"
#include "server/link/sessions.h"
#include "server/link/speakers.h"

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

class DdsServerLink : public ServerLink {
 public:
  DdsServerLink(const WireConfig& config, RunId server_run)
      : server_run_(server_run),
        opened_at_(Clock::now()),
        next_heartbeat_(opened_at_),
        heartbeat_(in_ms(config.silent_after_s / 4)),
        participant_(config, kName),
        sessions_(in_ms(2 * config.silent_after_s), participant_.rejections()),
        events_(kQueueCapacity, QueuePolicy::kDropOldest,
                [](const ServerEvent& e) { return std::holds_alternative<JoinedFrame>(e); }),
        status_writer_(participant_),
        moving_writer_(participant_),
        pose_writer_(participant_),
        public_writer_(participant_),
        loop_(participant_, "server-link", kTick, [this] { tick(); }) {
    status_.server_run = server_run;
    for_each_message_type([this]<class M, class S, class V>(const MessageType<M, S, V>&) {
      if constexpr (topic_of<M>().way == Way::kUp) read<M>();
    });
    loop_.read<idl::ServerStatus>([this](const idl::ServerStatus& m, const Sample&) { look_for_rival(m); });
    loop_.start();
  }

  std::optional<ServerEvent> next_event(milliseconds timeout) override {
    auto event = events_.pop_for(timeout);
    if (!event && events_.closed()) {
      throw UserError("another map server is at work in DDS domain " + std::to_string(participant_.config().domain) +
                      ": stop it, or choose another domain");
    }
    return event;
  }

  bool at_work() const override {
    const std::lock_guard lock(mutex_);
    return settled_;
  }

  void send(const MapPatch& patch) override {
    idl::MapPatch message = encode(patch);
    const std::lock_guard lock(mutex_);
    const auto path = paths_.find(patch.agent_run);
    if (path == paths_.end()) return;
    path->second.last = std::move(message);
    write_last(path->first, path->second);
  }

  void send(const MovingState& state) override {
    if (moving_writer_.readers() > 0) moving_writer_.write(encode(state));
  }

  void send(const AgentPose& pose) override {
    if (pose_writer_.readers() > 0) pose_writer_.write(encode(pose));
  }

  bool public_wanted() const override { return public_writer_.readers() > 0; }

  void send_public(const PublicSample& sample) override {
    if (public_wanted()) public_writer_.write(encode(sample));
  }

  void send_status(const ServerStatus& status) override {
    const std::lock_guard lock(mutex_);
    status_ = status;
    publish_status();
  }

  void refuse(const Hello& hello, const std::string& reason) override {
    const std::lock_guard lock(mutex_);
    sessions_.refuse(hello, reason);
    after_change();
  }

  LinkBytes bytes(const std::string& agent) const override {
    const std::lock_guard lock(mutex_);
    return sessions_.bytes(agent);
  }

  ServerLinkCounts counts() const override {
    const std::lock_guard lock(mutex_);
    return {events_.counts().dropped, sessions_.late_replies(), resent_};
  }

  const RejectionCounts& rejections() const override { return participant_.rejections(); }

 private:
  // The way back to one run: a writer in its partition.
  struct Path {
    Writer<idl::MapPatch> writer;
    idl::MapPatch last;  // sequence_number 0: none yet
    Path(Participant& participant, RunId run) : writer(participant, partition_of(run)) {}
  };

  void write_last(RunId run, Path& path) { sessions_.count_down(run, path.writer.write(path.last)); }

  void publish_status() {
    if (!settled_) return;
    ServerStatus status = status_;
    status.refused = sessions_.refused();
    published_refusals_ = status.refused.empty() ? RunId() : status.refused.back().agent_run;
    sessions_.count_down_all(status_writer_.write(encode(status)));
  }

  // On the loop's thread from here on, all under the mutex.
  template <class Message>
  void read() {
    constexpr bool kSignOfLife = topic_of<Message>().sign_of_life;
    Loop::OnPresence on_presence;
    if (kSignOfLife) on_presence = [this](const WriterId& w, Presence p) { presence(w, p); };
    loop_.read<Message>(
        [this](const Message& message, const Sample& sample) {
          const std::lock_guard lock(mutex_);
          const RunId run(message.agent_run());
          if (!speakers_.may_say(run, sample.writer, kSignOfLife))
            return participant_.rejections().add(Rejection::kWrongRun);
          sessions_.receive(message, sample.bytes, Clock::now());
          after_change();
        },
        on_presence);
  }

  void presence(const WriterId& writer, Presence presence) {
    const std::lock_guard lock(mutex_);
    const auto run = speakers_.run_of(writer);  // of hellos, whose writers are the agents' signs of life
    if (!run) return;
    sessions_.presence(*run, presence);
    if (presence == Presence::kGone) speakers_.gone(writer);
    after_change();
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

  bool may_settle(Instant now) const {
    const bool alone = std::ranges::count(participant_.others(), kName) == 0;
    return !events_.closed() && now - opened_at_ >= settling_time(participant_.config(), server_run_, alone);
  }

  void tick() {
    const std::lock_guard lock(mutex_);
    const Instant now = Clock::now();
    if (!settled_ && may_settle(now)) {
      settled_ = true;
      publish_status();
    }
    if (settled_ && now >= next_heartbeat_) {
      next_heartbeat_ = now + heartbeat_;
      status_writer_.assert_alive();
    }
    sessions_.tick(now);
    after_change();
  }

  void after_change() {
    open_paths();
    std::erase_if(paths_, [this](const auto& path) { return !sessions_.knows(path.first); });
    answer_repeated();
    for (ServerEvent& event : sessions_.take_events()) events_.push(std::move(event));
    const std::vector<Refusal>& refused = sessions_.refused();
    if (!refused.empty() && refused.back().agent_run != published_refusals_) publish_status();
  }

  // A run is let in when its reader has found our writer, since a patch sent before would be lost, and when it says
  // that it has found all that it hears and is heard by: play starts then.
  void open_paths() {
    if (!settled_) return;
    for (const RunId run : sessions_.waiting()) {
      const auto path = paths_.try_emplace(run, participant_, run).first;
      if (path->second.writer.readers() > 0 && sessions_.said_ready(run)) sessions_.open(run);
    }
  }

  // A frame that was answered came again: the answer may have been lost while the link was cut.
  void answer_repeated() {
    for (const auto& [run, frame] : sessions_.take_repeated()) {
      const auto path = paths_.find(run);
      if (path == paths_.end() || path->second.last.sequence_number() == 0) continue;
      if (FrameId(path->second.last.after_frame()) < frame) continue;  // not answered yet: the map thread is at it
      write_last(run, path->second);
      ++resent_;
    }
  }

  const RunId server_run_;
  const Instant opened_at_;
  Instant next_heartbeat_;
  const milliseconds heartbeat_;
  Participant participant_;

  mutable std::mutex mutex_;  // for all below but the queue
  Sessions sessions_;
  BoundedQueue<ServerEvent> events_;
  Writer<idl::ServerStatus> status_writer_;
  Writer<idl::MovingState> moving_writer_;
  Writer<idl::AgentPose> pose_writer_;
  Writer<idl::PublicSample> public_writer_;
  std::map<RunId, Path> paths_;
  Speakers speakers_;
  ServerStatus status_;
  RunId published_refusals_;  // the newest that agents were told of
  std::uint64_t resent_ = 0;
  bool settled_ = false;
  LogLimiter rival_log_;
  Loop loop_;  // last: stops first
};

}  // namespace

std::unique_ptr<ServerLink> open_server_link(const WireConfig& config, RunId server_run) {
  return std::make_unique<DdsServerLink>(config, server_run);
}

}  // namespace coslam
