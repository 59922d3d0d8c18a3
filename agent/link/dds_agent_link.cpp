// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/link/dds_agent_link.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>

#include "agent/link/inbox.h"
#include "common/wire/codec.h"
#include "common/wire/loop.h"
#include "common/wire/participant.h"

namespace coslam {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds kResend{300};
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

class DdsAgentLink : public AgentLink {
 public:
  DdsAgentLink(const WireConfig& config, const Hello& hello)
      : px_scale_(pixel_scale(hello.camera)),
        inbox_(hello.agent_run),
        participant_(config, "coslam-agent " + hello.agent),
        tracks_(participant_),
        patches_(participant_),
        descriptors_(participant_),
        hello_(participant_),
        status_(participant_),
        loop_(participant_, "agent-link", heartbeat(config), [this] { hello_.assert_alive(); }) {
    loop_.read<idl::MapPatch>([this](const idl::MapPatch& m, const Sample&) { receive(decode(m), [] {}); }, {},
                              partition_of(hello.agent_run));
    loop_.read<idl::ServerStatus>([this](const idl::ServerStatus& m, const Sample& s) { receive_status(m, s.writer); },
                                  [this](const WriterId& w, Presence p) { server_presence(w, p); });
    loop_.start();
    hello_.write(encode(hello));
  }

  void send(TrackFrame frame, const std::optional<PatchReply>& patches,
            const std::optional<DescriptorReply>& descriptors) override {
    frame.patches_sent = patches ? static_cast<std::uint16_t>(patches->patches.size()) : std::uint16_t{0};
    frame.descriptors_sent = descriptors.has_value();
    last_ = {};
    if (frame.patches_sent > 0) last_.patches = encode(*patches);
    if (descriptors) last_.descriptors = encode(*descriptors);
    last_.frame = encode(frame, px_scale_);
    last_.sent = Clock::now();
    write_replies();
    tracks_.write(*last_.frame);
  }

  void send_status(const AgentStatus& status) override { status_.write(encode(status)); }

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

  LinkBytes bytes() const override {
    const auto counts = participant_.counts();
    return {sum(counts, &TopicCounts::sent_bytes), sum(counts, &TopicCounts::received_bytes)};
  }

  const RejectionCounts& rejections() const override { return participant_.rejections(); }

 private:
  // What went out last, for repetition.
  struct Outgoing {
    std::optional<idl::TrackFrame> frame;
    std::optional<idl::PatchReply> patches;
    std::optional<idl::DescriptorReply> descriptors;
    Instant sent = Clock::now();
    int repetitions = 0;
  };

  void write_replies() {
    if (last_.patches) patches_.write(*last_.patches);
    if (last_.descriptors) descriptors_.write(*last_.descriptors);
  }

  void send_again(Instant now) {
    last_.sent = now;
    if (!last_.frame) return;
    if (++last_.repetitions % kRepliesEvery == 0) write_replies();
    tracks_.write(*last_.frame);
  }

  // On the loop's thread from here on. taken(): before anybody hears of the value.
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
    if (reason) participant_.rejections().add(*reason);
    arrived_.notify_all();
  }

  void receive_status(const idl::ServerStatus& message, const WriterId& writer) {
    receive(decode(message), [&] {
      server_ = writer;
      server_alive_ = true;
    });
  }

  void server_presence(const WriterId& writer, Presence presence) {
    const std::lock_guard lock(mutex_);
    if (writer == server_) server_alive_ = presence == Presence::kAlive;
  }

  const double px_scale_;
  Outgoing last_;  // of the sending thread

  mutable std::mutex mutex_;  // for the four below
  std::condition_variable arrived_;
  Inbox inbox_;
  WriterId server_;
  bool server_alive_ = false;

  Participant participant_;
  Writer<idl::TrackFrame> tracks_;
  Writer<idl::PatchReply> patches_;
  Writer<idl::DescriptorReply> descriptors_;
  Writer<idl::Hello> hello_;
  Writer<idl::AgentStatus> status_;  // after hello_: its end waits for the last word, before the sign of life ends
  Loop loop_;                        // last: stops first
};

}  // namespace

std::unique_ptr<AgentLink> open_agent_link(const WireConfig& config, const Hello& hello) {
  require_valid(hello);
  return std::make_unique<DdsAgentLink>(config, hello);
}

}  // namespace coslam
