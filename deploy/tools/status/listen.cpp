// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/tools/status/listen.h"

#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>

#include "common/base/error.h"
#include "common/wire/codec.h"
#include "common/wire/loop.h"
#include "common/wire/participant.h"
#include "deploy/tools/status/census.h"

namespace coslam {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kPatience{3}, kWindow{2};

class Listener {
 public:
  explicit Listener(const WireConfig& config)
      : participant_(config, "coslam-status"), loop_(participant_, "status", std::chrono::milliseconds(100), [] {}) {
    read<idl::TrackFrame>();
    read<idl::PatchReply>();
    read<idl::DescriptorReply>();
    read<idl::AgentStatus>();
    read<idl::MapPatch>("run-*");
    read<idl::MovingState>();
    loop_.read<idl::Hello>(
        [this](const idl::Hello& m, const Sample& s) {
          origins_[s.writer] = RunId(m.agent_run());
          take(m, s);
        },
        [this](const WriterId& w, Presence p) { presence(w, p); });
    loop_.read<idl::ServerStatus>(
        [this](const idl::ServerStatus& m, const Sample& s) {
          origins_[s.writer] = RunId(m.server_run());
          const std::lock_guard lock(mutex_);
          if (auto status = decode(m)) census_.add(*status);
          heard_.notify_all();
        },
        [this](const WriterId& w, Presence p) { presence(w, p); });
    loop_.start();
  }

  std::string wait() {
    std::unique_lock lock(mutex_);
    if (!heard_.wait_for(lock, kPatience, [this] { return !census_.empty(); })) {
      throw UserError("nobody was heard in DDS domain " + std::to_string(participant_.config().domain) +
                      ": another domain, or a firewall, or no multicast between the machines?");
    }
    lock.unlock();
    std::this_thread::sleep_for(kWindow);
    lock.lock();
    return census_.text(Clock::now());
  }

 private:
  template <class Message>
  void read(const std::string& partition = {}) {
    loop_.read<Message>([this](const Message& m, const Sample& s) { take(m, s); }, {}, partition);
  }

  // On the loop's thread from here on.
  template <class Message>
  void take(const Message& message, const Sample& sample) {
    const std::lock_guard lock(mutex_);
    if (auto value = decode(message)) census_.add(*value, sample.bytes, Clock::now());
    heard_.notify_all();
  }

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

std::string listen_for_status(const WireConfig& config) { return Listener(config).wait(); }

}  // namespace coslam
