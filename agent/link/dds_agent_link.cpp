// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/link/dds_agent_link.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <shared_mutex>

#include "agent/link/inbox.h"
#include "agent/link/reply_writers.h"
#include "common/base/error.h"
#include "common/base/log.h"
#include "common/flow/clock.h"
#include "common/wire/address_watch.h"
#include "common/wire/codec.h"
#include "common/wire/loop.h"
#include "common/wire/participant.h"
#include "common/wire/reply_parts.h"
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

std::uint64_t sum(const std::array<TopicCounts, kTopicCount>& counts, std::uint64_t TopicCounts::*field) {
  std::uint64_t total = 0;
  for (const TopicCounts& c : counts) total += c.*field;
  return total;
}

// What a link has in the domain.
struct Ends {
  Participant participant;
  std::deque<Writer<idl::TrackFrame>> tracks;  // in turn
  ReplyWriters<idl::PatchReply> patches{participant};
  ReplyWriters<idl::DescriptorReply> descriptors{participant};
  std::optional<Writer<idl::Hello>> hello;
  Writer<idl::Thumbnail> thumbnail{participant};
  Writer<idl::AgentStatus> status{
      participant};  // after hello: its end waits for the last word, before the sign of life
  Loop loop;         // last: stops first

  Ends(const WireConfig& config, const std::string& agent, std::shared_ptr<RejectionCounts> rejections,
       const std::function<void(Ends&)>& on_tick)
      : participant(config, "coslam-agent " + agent, std::move(rejections)),
        loop(participant, "agent-link", kTick, [this, on_tick] { on_tick(*this); }) {}

  void forget_what_is_repeated_soon() {
    patches.soon.forget();
    descriptors.soon.forget();
  }

  // Both ways of every topic: where a word of discovery is lost, that takes seconds.
  bool whole() const {
    const auto found = [](const auto& writer) { return writer.readers() > 0; };
    return std::ranges::all_of(tracks, found) && found(patches) && found(descriptors) && found(*hello) &&
           found(status) && loop.writers<idl::MapPatch>() > 0;
  }
};

class DdsAgentLink : public AgentLink {
 public:
  DdsAgentLink(const WireConfig& config, const Hello& hello, const AddressWatch::Addresses& addresses)
      : config_(config),
        hello_(hello),
        encoder_(pixel_scale(hello.camera)),
        inbox_(hello.agent_run),
        heartbeat_(heartbeat(config)) {
    ready_.agent = hello.agent;
    ready_.agent_run = hello.agent_run;
    ends_ = open();
    addresses_.emplace(addresses, [this] { return join_anew(); });
  }

  void send(TrackFrame frame, const std::optional<PatchReply>& patches,
            const std::optional<DescriptorReply>& descriptors) override {
    last_ = {};
    if (patches) put_parts(*patches, patches_waiting_, last_.patches);
    if (descriptors) {
      put_parts(*descriptors, descriptors_waiting_, last_.descriptors);
      described_ = Clock::now();
    }
    last_.sent = Clock::now();
    const std::optional<FrameId> known = acknowledged();
    const std::shared_lock lock(ends_mutex_);
    if (ends_) write_waiting();
    // What waits rides with a later frame, so that this one does not wait for it.
    const bool patches_gone = ends_ && patches && patches_waiting_.empty();
    frame.patches_sent = patches_gone ? static_cast<std::uint16_t>(patches->patches.size()) : std::uint16_t{0};
    if (descriptors && descriptors->frame == frame.frame) {
      const bool are_sent = ends_ && descriptors_waiting_.empty();
      frame.descriptors_sent = are_sent ? DescriptorsSent::kWithFrame : DescriptorsSent::kLater;
    }
    // Joining anew: lost, as on a link that is cut.
    if (ends_) ends_->tracks[frame.frame.value % ends_->tracks.size()].write(encoder_.encode(frame, known));
    last_.frame = std::move(frame);
  }

  void send_status(const AgentStatus& status) override {
    const std::shared_lock lock(ends_mutex_);
    if (ends_) say(*ends_, status);
  }

  bool take_thumbnail_request() override {
    const std::lock_guard lock(mutex_);
    return inbox_.take_thumbnail_request();
  }
  void send_thumbnail(const Thumbnail& thumbnail) override {
    const std::shared_lock lock(ends_mutex_);
    if (ends_) ends_->thumbnail.write(encode(thumbnail));
  }

  void limit_replies(const ReplyLimits& limits) override {
    const bool was_narrow = limits_ && limits_->narrow_link;
    limits_ = limits;
    if (!limits.narrow_link || was_narrow) return;
    // What waits in the queue of a narrow link would be sent again and again, and keep it full.
    const std::shared_lock lock(ends_mutex_);
    if (ends_) ends_->forget_what_is_repeated_soon();
  }
  RepliesWaiting waiting() const override {
    return {!patches_waiting_.empty(), !descriptors_waiting_.empty(), reply_bytes_};
  }

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
    return least_took_s_;
  }

  LinkBytes bytes() const override {
    const std::shared_lock lock(ends_mutex_);
    LinkBytes all = bytes_before_;
    if (ends_) add_bytes(*ends_, all);
    return all;
  }

  const RejectionCounts& rejections() const override { return *rejections_; }

 private:
  // What went out last, for repetition.
  struct Outgoing {
    std::optional<TrackFrame> frame;
    std::vector<idl::PatchReply> patches;
    std::vector<idl::DescriptorReply> descriptors;
    Instant sent = Clock::now();
    int repetitions = 0;
  };

  std::unique_ptr<Ends> open() {
    auto ends = std::make_unique<Ends>(config_, hello_.agent, rejections_, [this](Ends& e) { tick(e); });
    ends->loop.read<idl::MapPatch>([this](const idl::MapPatch& m, const Sample&) { receive_patch(decode(m)); }, {},
                                   partition_of(hello_.agent_run));
    ends->loop.read<idl::AgentImages>([this](const idl::AgentImages& m, const Sample&) { receive(decode(m), [] {}); },
                                      {}, partition_of(hello_.agent_run));
    ends->loop.read<idl::ThumbnailRequest>(
        [this](const idl::ThumbnailRequest& m, const Sample&) { receive(decode(m), [] {}); }, {},
        partition_of(hello_.agent_run));
    ends->loop.read<idl::ServerStatus>([this](const idl::ServerStatus& m, const Sample& s) { receive_status(m, s); },
                                       [this](const WriterId& w, Presence p) { server_presence(w, p); });
    const int ways = hello_.pacing == Pacing::kLive ? kWays : 1;
    for (int i = 0; i < ways; ++i) ends->tracks.emplace_back(ends->participant);
    // Last: who has found it has found the others, which the middleware makes known in order.
    ends->hello.emplace(ends->participant);
    ends->loop.start();
    ends->hello->write(encode(hello_));
    return ends;
  }

  static void add_bytes(const Ends& ends, LinkBytes& to) {
    const auto counts = ends.participant.counts();
    to.up += sum(counts, &TopicCounts::sent_bytes);
    to.down += sum(counts, &TopicCounts::received_bytes);
  }

  bool join_anew() {
    std::unique_ptr<Ends> before;
    {
      const std::unique_lock lock(ends_mutex_);
      before = std::move(ends_);
      if (before) add_bytes(*before, bytes_before_);
    }
    if (before) {
      log_info("this machine's addresses changed: joining DDS domain " + std::to_string(config_.domain) + " anew");
      before->participant.give_up();
      before.reset();  // says farewell: the server lets a run speak from one place only
      const std::lock_guard lock(mutex_);
      said_ready_ = false;
      joined_anew_ = true;
      set_server_alive(false);
    }
    try {
      auto fresh = open();
      const std::unique_lock lock(ends_mutex_);
      ends_ = std::move(fresh);
      return true;
    } catch (const UserError& error) {
      if (cannot_join_.pass()) log_warn(error.what());
      return false;
    }
  }

  std::optional<FrameId> acknowledged() const {
    const std::lock_guard lock(mutex_);
    return inbox_.acknowledged();
  }

  template <class Reply, class Message>
  void put_parts(const Reply& reply, std::deque<Message>& waiting, std::vector<Message>& last) {
    for (const Reply& part : in_parts(reply)) {
      waiting.push_back(encode(part));
      if (!limits_) last.push_back(waiting.back());
    }
  }

  // Descriptors first: they are rare, and where maps have not met everything hangs on them. On a narrow link they would
  // keep patches waiting for seconds, which take little room and are asked for where they tell something. Descriptors
  // of long ago are left: few of their tracks are there still.
  void write_waiting() {
    constexpr double kUnlimited = 1e12, kMostLeft = 1500;  // bytes that were not used last time
    constexpr std::chrono::milliseconds kStale{2500};
    reply_room_ = limits_ ? std::min(reply_room_, kMostLeft) + limits_->bytes_a_frame : kUnlimited;
    if (Clock::now() - described_ > kStale) descriptors_waiting_.clear();
    if (limits_ && limits_->narrow_link) write_waiting(patches_waiting_, ends_->patches);
    write_waiting(descriptors_waiting_, ends_->descriptors);
    write_waiting(patches_waiting_, ends_->patches);
  }
  template <class Message>
  void write_waiting(std::deque<Message>& waiting, ReplyWriters<Message>& writers) {
    Writer<Message>& writer = limits_ && !limits_->narrow_link ? writers.soon : writers.usual;
    for (; !waiting.empty() && reply_room_ > 0; waiting.pop_front()) {
      if (limits_ && reply_bytes_ >= limits_->up_to_bytes) return;
      const auto bytes = static_cast<double>(writer.write(waiting.front()));
      reply_room_ -= bytes;
      reply_bytes_ += bytes;
    }
  }

  // Lock-step.
  void write_replies() {
    for (const auto& part : last_.patches) ends_->patches.usual.write(part);
    for (const auto& part : last_.descriptors) ends_->descriptors.usual.write(part);
  }

  void send_again(Instant now) {
    last_.sent = now;
    const std::shared_lock lock(ends_mutex_);
    if (!last_.frame || !ends_) return;
    if (++last_.repetitions % kRepliesEvery == 0) write_replies();
    // What it was coded against may be what the server lacks.
    ends_->tracks.front().write(encoder_.encode_alone(*last_.frame));
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
      say(ends, ready_);
    } else if (joined_anew_ && ends.hello->readers() > 0 && now >= next_hello_) {
      // The server did not listen while it took this run for another process's.
      next_hello_ = now + kHelloAgain;
      ends.hello->write(encode(hello_));
    }
  }

  void say(Ends& ends, const AgentStatus& status) {
    said_ready_ = true;
    ends.status.write(encode(status));
  }

  // taken(): before anybody hears of the value.
  template <class Value, class Taken>
  void receive(Decoded<Value> value, Taken taken) {
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

  void receive_patch(Decoded<MapPatch> patch) {
    if (patch) patch->received_ns = utc_now_ns();
    receive(std::move(patch), [] {});
  }

  void receive_status(const idl::ServerStatus& message, const Sample& sample) {
    receive(decode(message), [&] {
      const double took_s = to_seconds(utc_now_ns() - sample.written_ns);
      const bool first = sample.writer != server_;
      // Nothing takes less than no time, none is kept for three seconds, and the word to start is written before it.
      const bool at_start = message.started() && message.start_utc_ns() > sample.written_ns;
      const bool is_new = !first || took_s < 0 || took_s > 3 || at_start;
      if (first) least_took_s_.reset();
      if (is_new) least_took_s_ = std::min(least_took_s_.value_or(took_s), took_s);
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
  std::deque<idl::PatchReply> patches_waiting_;
  std::deque<idl::DescriptorReply> descriptors_waiting_;
  std::optional<ReplyLimits> limits_;  // none in lock-step
  double reply_room_ = 0, reply_bytes_ = 0;
  Instant described_{};

  mutable std::mutex mutex_;  // for the five below
  std::condition_variable arrived_;
  Inbox inbox_;
  WriterId server_;
  std::optional<double> least_took_s_;  // of the new statuses of this server
  bool server_alive_ = false;

  mutable std::shared_mutex ends_mutex_;  // for the two below; held for a write at most
  std::unique_ptr<Ends> ends_;            // none while it joins anew
  LinkBytes bytes_before_;                // of those before
  AgentStatus ready_;                     // nothing to tell but that it hears and is heard
  std::atomic<bool> said_ready_{false}, joined_anew_{false};
  const milliseconds heartbeat_;
  Instant next_heartbeat_{}, next_hello_{};  // of the loop's thread
  LogLimiter cannot_join_;
  std::optional<AddressWatch> addresses_;  // last: stops first
};

}  // namespace

std::unique_ptr<AgentLink> open_agent_link(const WireConfig& config, const Hello& hello,
                                           const AddressWatch::Addresses& addresses) {
  require_valid(hello);
  return std::make_unique<DdsAgentLink>(config, hello, addresses);
}

}  // namespace coslam
