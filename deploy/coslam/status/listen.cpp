// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/status/listen.h"

#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>

#include "common/base/error.h"
#include "common/wire/codec.h"
#include "common/wire/loop.h"
#include "common/wire/participant.h"
#include "deploy/coslam/status/census.h"

namespace coslam {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kPatience{3}, kWindow{2}, kAgain{1};

// What the census has no place for is made only for those who read it or ask for it, and tells nothing of the link.
template <class Value>
concept Heeded = requires(Census& census, const Value& value) {
  census.add(value, 0, Clock::now());
};

class Listener {
 public:
  explicit Listener(const WireConfig& config)
      : participant_(config, "coslam-status"), loop_(participant_, "status", std::chrono::milliseconds(100), [] {}) {
    for_each_message_type([this]<class M, class S, class V>(const MessageType<M, S, V>&) {
      if constexpr (Heeded<V>) read<M>();
    });
    loop_.start();
  }

  void run(const StatusOptions& options, const std::function<void(const std::string&)>& tell) {
    std::unique_lock lock(mutex_);
    if (!heard_.wait_for(lock, kPatience, [this] { return !census_.empty(); })) {
      const bool strangers = participant_.rejections()[Rejection::kUnauthentic] > 0;
      throw UserError("nobody was heard in DDS domain " + std::to_string(participant_.config().domain) +
                      (strangers ? " who has the same key: others are there, with another one or none"
                                 : ": another domain or key, or a firewall, or no multicast between the machines?"));
    }
    for (auto pause = kWindow;; pause = kAgain) {
      lock.unlock();
      std::this_thread::sleep_for(pause);
      lock.lock();
      tell(options.json ? census_.json(Clock::now()) : census_.text(Clock::now()));
      if (!options.watch) return;
    }
  }

 private:
  template <class Message>
  void read() {
    constexpr Topic kTopic = topic_of<Message>();
    Loop::OnPresence on_presence;
    if (kTopic.sign_of_life) on_presence = [this](const WriterId& w, Presence p) { presence(w, p); };
    loop_.read<Message>([this](const Message& m, const Sample& s) { take(m, s); }, on_presence,
                        kTopic.by_run ? kAllRuns : "");
  }

  // On the loop's thread from here on.
  template <class Message>
  void take(const Message& message, const Sample& sample) {
    auto value = decoded(message);
    if (!value) return;
    note_origin(sample.writer, *value);
    const std::lock_guard lock(mutex_);
    census_.add(*value, sample.bytes, Clock::now());
    heard_.notify_all();
  }

  template <class Message>
  static auto decoded(const Message& message) {
    return decode(message);
  }
  // Who comes late has not heard the frames that others are coded against.
  static auto decoded(const idl::TrackFrame& message) { return decode_header(message); }

  template <class Value>
  void note_origin(const WriterId&, const Value&) {}  // gives no sign of life
  void note_origin(const WriterId& writer, const Hello& hello) { origins_[writer] = hello.agent_run; }
  void note_origin(const WriterId& writer, const ServerStatus& status) { origins_[writer] = status.server_run; }

  void presence(const WriterId& writer, Presence presence) {
    const auto origin = origins_.find(writer);
    if (origin == origins_.end()) return;
    const std::lock_guard lock(mutex_);
    census_.set_alive(origin->second, presence == Presence::kAlive);
  }

  std::map<WriterId, RunId> origins_;  // whose signs of life; of the loop's thread
  std::mutex mutex_;                   // for the two below
  std::condition_variable heard_;
  Census census_;
  Participant participant_;
  Loop loop_;  // last: stops first
};

}  // namespace

void listen_for_status(const WireConfig& config, const StatusOptions& options,
                       const std::function<void(const std::string&)>& tell) {
  Listener(config).run(options, tell);
}

}  // namespace coslam
