// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/link/dds_agent_link.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <type_traits>

#include "agent/link/agent_ends.h"
#include "agent/link/clock_lead.h"
#include "agent/link/inbox.h"
#include "agent/link/reply_queue.h"
#include "common/flow/clock.h"
#include "common/wire/codec.h"
#include "common/wire/membership.h"
#include "common/wire/track_codec.h"

namespace coslam {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds kResend{300}, kTick{20}, kHelloAgain{1000};
// The middleware drops a best-effort sample that comes after a later one of the same writer. With several in turn, a
// link may let frames overtake each other by as many.
constexpr int kWays = 6;
constexpr int kRepliesEvery = 10;  // replies travel reliably: send them again in every 10th repetition only

// Three signs of life within the time after which their absence counts.
milliseconds heartbeat(const WireConfig& config) {
  return milliseconds(std::max(10L, std::lround(1000 * config.silent_after_s / 4)));
}

using Ends = AgentEnds;

class DdsAgentLink : public AgentLink {
 public:
  DdsAgentLink(const WireConfig& config, const Hello& hello, const AddressWatch::Addresses& addresses)
      : config_(config),
        hello_(hello),
        encoder_(pixel_scale(hello.camera)),
        inbox_(hello.agent_run),
        ready_{.agent = hello.agent, .agent_run = hello.agent_run},
        heartbeat_(heartbeat(config)),
        membership_({.open = [this] { return open(); },
                     .leaving = [this](const Ends& e) { bytes_before_ = sum(bytes_before_, e.bytes()); },
                     .left = [this] { start_anew(); },
                     .joined_anew = [](Ends&) {}},
                    addresses) {}

  void send(TrackFrame frame, const std::optional<PatchReply>& patches,
            const std::optional<DescriptorReply>& descriptors) override {
    last_ = {};
    replies_.put(patches, descriptors, last_.sent);
    const std::optional<FrameId> known = acknowledged();
    const auto ends = membership_.ends();
    if (ends) replies_.write(ends->replies, last_.sent);
    // What waits rides with a later frame, so that this one does not wait for it.
    const bool patches_gone = ends && patches && !replies_.patches_wait();
    frame.patches_sent = patches_gone ? static_cast<std::uint16_t>(patches->patches.size()) : std::uint16_t{0};
    if (descriptors && descriptors->frame == frame.frame) {
      const bool are_sent = ends && !replies_.descriptors_wait();
      frame.descriptors_sent = are_sent ? DescriptorsSent::kWithFrame : DescriptorsSent::kLater;
    }
    // Joining anew: lost, as on a link that is cut.
    if (ends) ends->tracks[frame.frame.value % ends->tracks.size()].write(encoder_.encode(frame, known));
    last_.frame = std::move(frame);
  }

  void send(const AgentMessage& message) override {
    const auto ends = membership_.ends();
    if (ends) message.visit([&](const auto& value) { write(*ends, value); });
  }

  bool take_thumbnail_request() override {
    const std::lock_guard lock(mutex_);
    return inbox_.take_thumbnail_request();
  }

  void limit_replies(const ReplyLimits& limits) override {
    if (!replies_.limit(limits)) return;
    // What waits in the queue of a narrow link would be sent again and again, and keep it full.
    if (const auto ends = membership_.ends()) ends->replies.forget_soon();
  }
  RepliesWaiting waiting() const override { return replies_.waiting(); }

  std::optional<MapPatch> wait_patch(FrameId after_frame, milliseconds timeout) override {
    const Instant deadline = Clock::now() + timeout;
    std::unique_lock lock(mutex_);
    while (!inbox_.answered(after_frame)) {
      if (auto patch = inbox_.pop()) return patch;
      const Instant now = Clock::now();
      if (now >= deadline) break;
      if (now >= last_.sent + kResend) send_again(now);
      arrived_.wait_until(lock, std::min(deadline, last_.sent + kResend));
    }
    return std::nullopt;
  }

  std::vector<MapPatch> take_patches() override {
    const std::lock_guard lock(mutex_);
    std::vector<MapPatch> patches;
    while (auto patch = inbox_.pop()) patches.push_back(std::move(*patch));
    return patches;
  }

  std::optional<ServerStatus> server_status() const override {
    const std::lock_guard lock(mutex_);
    return inbox_.status();
  }

  std::optional<ServerStatus> wait_server_status(milliseconds timeout) override {
    std::unique_lock lock(mutex_);
    std::optional<ServerStatus> status;
    arrived_.wait_for(lock, timeout, [&] { return (status = inbox_.take_fresh_status()).has_value(); });
    return status;
  }

  bool server_alive() const override {
    const std::lock_guard lock(mutex_);
    return server_alive_;
  }

  std::optional<AgentImages> images() const override {
    const std::lock_guard lock(mutex_);
    return inbox_.images();
  }

  std::optional<double> clock_ahead_s() const override {
    const std::lock_guard lock(mutex_);
    return clock_lead_.seconds();
  }

  LinkBytes bytes() const override {
    const auto ends = membership_.ends();
    return ends ? sum(bytes_before_, ends->bytes()) : bytes_before_;
  }

  const RejectionCounts& rejections() const override { return *rejections_; }

 private:
  // What went out last, for repetition.
  struct Outgoing {
    std::optional<TrackFrame> frame;
    Instant sent = Clock::now();
    int repetitions = 0;
  };

  std::unique_ptr<Ends> open() {
    auto ends = std::make_unique<Ends>(config_, hello_.agent, rejections_, kTick, [this](Ends& e) { tick(e); });
    for_each_message_type([&]<class M, class S, class V>(const MessageType<M, S, V>&) {
      if constexpr (ReadByAgents<V>) read<M>(*ends);
    });
    const int ways = hello_.pacing == Pacing::kLive ? kWays : 1;
    for (int i = 0; i < ways; ++i) ends->tracks.emplace_back(ends->participant);
    // Last: who has found it has found the others, which the middleware makes known in order.
    ends->hello.emplace(ends->participant);
    ends->loop.start();
    ends->hello->write(encode(hello_));
    return ends;
  }

  template <class Message>
  void read(Ends& ends) {
    constexpr Topic kTopic = topic_of<Message>();
    Loop::OnPresence on_presence;
    if (kTopic.sign_of_life) on_presence = [this](const WriterId& w, Presence p) { server_presence(w, p); };
    ends.loop.read<Message>([this](const Message& m, const Sample& s) { receive(m, s); }, on_presence,
                            kTopic.by_run ? partition_of(hello_.agent_run) : "");
  }

  static LinkBytes sum(const LinkBytes& a, const LinkBytes& b) { return {a.up + b.up, a.down + b.down}; }

  // The server lets a run speak from one place only, and has heard the farewell.
  void start_anew() {
    const std::lock_guard lock(mutex_);
    said_ready_ = false;
    joined_anew_ = true;
    set_server_alive(false);
  }

  std::optional<FrameId> acknowledged() const {
    const std::lock_guard lock(mutex_);
    return inbox_.acknowledged();
  }

  void send_again(Instant now) {
    last_.sent = now;
    const auto ends = membership_.ends();
    if (!last_.frame || !ends) return;
    if (++last_.repetitions % kRepliesEvery == 0) replies_.write_again(ends->replies);
    // What it was coded against may be what the server lacks.
    ends->tracks.front().write(encoder_.encode_alone(*last_.frame));
  }

  // On the loop's thread from here on.
  void tick(Ends& ends) {
    const Instant now = Clock::now();
    if (now >= next_heartbeat_) {
      next_heartbeat_ = now + heartbeat_;
      ends.hello->assert_alive();
    }
    if (said_ready_) return;
    if (ends.whole() && server_status()) {
      write(ends, ready_);
    } else if (joined_anew_ && ends.hello->readers() > 0 && now >= next_hello_) {
      // The server did not listen while it took this run for another process's.
      next_hello_ = now + kHelloAgain;
      ends.hello->write(encode(hello_));
    }
  }

  template <class Value>
  void write(Ends& ends, const Value& value) {
    if constexpr (std::is_same_v<Value, AgentStatus>) said_ready_ = true;  // whatever a status says
    auto message = encode(value);
    ends.plain.template writer<decltype(message)>().write(message);
  }

  // taken(): before anybody hears of the value.
  template <class Value, class Taken>
  void take(Decoded<Value> value, const Taken& taken) {
    std::optional<Rejection> reason;
    if (value) {
      const std::lock_guard lock(mutex_);
      reason = inbox_.add(std::move(*value));
      if (!reason) taken();
    } else {
      reason = value.rejection();
    }
    if (reason) rejections_->add(*reason);
    arrived_.notify_all();
  }

  template <class Message>
  void receive(const Message& message, const Sample&) {
    take(decode(message), [] {});
  }
  void receive(const idl::MapPatch& message, const Sample&) {
    Decoded<MapPatch> patch = decode(message);
    if (patch) patch->received_ns = utc_now_ns();
    take(std::move(patch), [] {});
  }
  void receive(const idl::ServerStatus& message, const Sample& sample) {
    take(decode(message), [&] {
      // The word to start is written before the start.
      const bool at_start = message.started() && message.start_utc_ns() > sample.written_ns;
      clock_lead_.note(to_seconds(utc_now_ns() - sample.written_ns), sample.writer != server_, at_start);
      server_ = sample.writer;
      set_server_alive(true);
    });
  }

  void server_presence(const WriterId& writer, Presence presence) {
    const std::lock_guard lock(mutex_);
    if (writer == server_) set_server_alive(presence == Presence::kAlive);
  }

  void set_server_alive(bool alive) {
    server_alive_ = alive;
    inbox_.set_server_alive(alive);
  }

  const WireConfig config_;
  const Hello hello_;
  const std::shared_ptr<RejectionCounts> rejections_ = std::make_shared<RejectionCounts>();

  TrackEncoder encoder_;  // of the sending thread, as are the next
  Outgoing last_;
  ReplyQueue replies_;

  mutable std::mutex mutex_;  // for the five below
  std::condition_variable arrived_;
  Inbox inbox_;
  WriterId server_;
  ClockLead clock_lead_;
  bool server_alive_ = false;

  LinkBytes bytes_before_;   // of ends that are closed; guarded as the ends are
  const AgentStatus ready_;  // nothing to tell but that it hears and is heard
  std::atomic<bool> said_ready_{false}, joined_anew_{false};
  const milliseconds heartbeat_;
  Instant next_heartbeat_{}, next_hello_{};  // of the loop's thread
  Membership<Ends> membership_;              // last: stops first
};

}  // namespace

std::unique_ptr<AgentLink> open_agent_link(const WireConfig& config, const Hello& hello,
                                           const AddressWatch::Addresses& addresses) {
  require_valid(hello);
  return std::make_unique<DdsAgentLink>(config, hello, addresses);
}

}  // namespace coslam
