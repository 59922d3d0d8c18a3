// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A holder of the fleet's key that lies: takes part as the agent "liar" and says what no agent says, until it is
// killed.
//   liar DOMAIN KEY_FILE quiet       joins in lock-step, says that it has ended, and no more
//   liar DOMAIN KEY_FILE lockstep    the same, and then only what can be told to be wrong by itself
//   liar DOMAIN KEY_FILE live        besides 300 frames a second where it announced 30, of any time, with tracks of
//   nothing
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/base/time.h"
#include "common/flow/clock.h"
#include "common/wire/codec.h"
#include "common/wire/loop.h"
#include "common/wire/participant.h"
#include "tests/support/wire_values.h"

namespace coslam {
namespace {

using namespace std::chrono_literals;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr RunId kRun(0x11a2);

class Liar {
 public:
  Liar(const WireConfig& config, Pacing pacing)
      : pacing_(pacing),
        participant_(config, "coslam-agent liar"),
        hellos_(participant_),
        frames_(participant_),
        patches_(participant_),
        descriptors_(participant_),
        statuses_(participant_),
        loop_(participant_, "liar", 50ms, [this] { hellos_.assert_alive(); }) {
    loop_.read<idl::Hello>([this](const idl::Hello& m, const Sample&) { hear(m); });
    // Of all runs: that somebody reads them is what lets a run in.
    loop_.read<idl::MapPatch>([this](const idl::MapPatch& m, const Sample&) { answered(m); }, {}, kAllRuns);
    loop_.read<idl::ServerStatus>([this](const idl::ServerStatus& m, const Sample&) { started(m); });
    loop_.start();
  }

  void join() {
    hellos_.write(encode(hello("liar", kRun)));
    statuses_.write(encode(values_.agent_status("liar", kRun, AgentState::kWaiting)));
    while (!started_) std::this_thread::sleep_for(10ms);
    if (pacing_ == Pacing::kLockstep)
      statuses_.write(encode(values_.agent_status("liar", kRun, AgentState::kFinished)));
    std::puts("joined");
    std::fflush(stdout);
  }

  void lie(std::size_t i) {
    lies_[i % lies_.size()]();
    if (pacing_ == Pacing::kLive) frames_.write(coded(next()));
  }

 private:
  void hear(const idl::Hello& message) {
    auto hello = decode(message);
    if (!hello || hello->agent != "cam0") return;
    const std::lock_guard lock(mutex_);
    victim_ = hello->agent_run;
  }
  void answered(const idl::MapPatch& message) {
    const std::lock_guard lock(mutex_);
    if (RunId(message.agent_run()) == victim_) victim_frame_ = FrameId(message.after_frame());
  }
  void started(const idl::ServerStatus& message) {
    if (!message.started()) return;
    start_utc_ns_ = message.start_utc_ns();
    started_ = true;
  }

  Hello hello(const std::string& name, RunId run) { return values_.hello(name, run, pacing_); }

  // As agents that replay date their images.
  TimeNs played_now_ns() const { return utc_now_ns() - start_utc_ns_; }
  // A frame as it should be, now, of nothing.
  TrackFrame next() {
    TrackFrame f = values_.frame("liar", kRun, ++number_, 100);
    f.capture_ns = played_now_ns();
    if (number_ % 5 == 1) f.capture_ns += to_ns(values_.uniform(-4000, 4000));
    if (number_ % 50 == 2) f.capture_ns = std::numeric_limits<TimeNs>::max();
    if (number_ % 50 == 3) f.capture_ns = std::numeric_limits<TimeNs>::min();
    return f;
  }
  static idl::TrackFrame coded(const TrackFrame& frame) { return encode(frame, pixel_scale(test::vga_camera())); }
  template <class Spoil>
  void frame_but(Spoil spoil) {
    idl::TrackFrame message = coded(next());
    spoil(message);
    frames_.write(message);
  }

  // As cam0, of which it has heard all.
  void as_another() {
    TrackFrame f = values_.frame("cam0", RunId(), 0, 100);
    {
      const std::lock_guard lock(mutex_);
      f.agent_run = victim_;
      f.frame = FrameId(victim_frame_.value + 1);
    }
    if (f.agent_run == RunId()) return;
    f.capture_ns = played_now_ns();
    frames_.write(coded(f));
    statuses_.write(encode(values_.agent_status("cam0", f.agent_run, AgentState::kFinished)));
    hellos_.write(encode(hello("cam0", f.agent_run)));
    f.agent = "liar";
    frames_.write(coded(f));
    f.agent = "cam0";
    f.agent_run = kRun;
    frames_.write(coded(f));
  }

  // The next of 200 names, each with a run of its own.
  void another_name() {
    const std::uint32_t number = names_++ % 200;
    const std::string name = "name" + std::to_string(number);
    hellos_.write(encode(hello(name, RunId(1000 + number))));
    frames_.write(coded(values_.frame(name, RunId(1000 + number), names_, 5)));
  }

  const Pacing pacing_;
  test::WireValues values_{5};
  std::uint32_t number_ = 0, names_ = 0;
  std::mutex mutex_;
  RunId victim_;
  FrameId victim_frame_;
  std::atomic<bool> started_{false};
  std::atomic<TimeNs> start_utc_ns_{0};

  const std::vector<std::function<void()>> lies_{
      [this] { frame_but([](auto& m) { m.rotation()[0] = kNan; }); },
      [this] { frame_but([](auto& m) { m.translation()[1] = INFINITY; }); },
      [this] { frame_but([](auto& m) {
                 m.rotation() = {2, 0, 0, 0};
               }); },
      [this] { frame_but([](auto& m) { m.hull_fraction(700); }); },
      [this] { frame_but([](auto& m) { m.track_count(65535); }); },
      [this] { frame_but([](auto& m) { m.tracks().assign(idl::MAX_TRACK_BYTES, 0xff); }); },
      [this] { frame_but([](auto& m) { m.tags().assign(17, 1); }); },
      [this] { frame_but([](auto& m) { m.reference_age(9); }); },
      [this] { frame_but([](auto& m) { m.agent_run(0); }); },
      [this] { frame_but([](auto& m) { m.agent("\x1b[2J"); }); },
      [this] { frame_but([](auto& m) { m.agent("nobody"), m.agent_run(99); }); },
      [this] {
        idl::Hello m = encode(hello("old", RunId(98)));
        m.protocol(1);
        hellos_.write(m);
      },
      [this] {
        idl::PatchReply m = encode(values_.patches(next(), 4));
        m.parts(65535);
        patches_.write(m);
      },
      [this] {
        idl::DescriptorReply m = encode(values_.descriptors(next(), 4));
        m.descriptors().resize(5);
        descriptors_.write(m);
      },
      [this] { as_another(); },
      [this] { another_name(); },
  };

  Participant participant_;
  Writer<idl::Hello> hellos_;
  Writer<idl::TrackFrame> frames_;
  Writer<idl::PatchReply> patches_;
  Writer<idl::DescriptorReply> descriptors_;
  Writer<idl::AgentStatus> statuses_;
  Loop loop_;  // last: stops first
};

[[noreturn]] void lie_on(const WireConfig& config, const std::string& how) {
  constexpr auto kPeriod = std::chrono::microseconds(3333);
  Liar liar(config, how == "live" ? Pacing::kLive : Pacing::kLockstep);
  liar.join();
  while (how == "quiet") std::this_thread::sleep_for(1h);
  auto due = std::chrono::steady_clock::now();
  for (std::size_t i = 0;; ++i) {
    liar.lie(i);
    std::this_thread::sleep_until(due += kPeriod);
  }
}

}  // namespace
}  // namespace coslam

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  coslam::WireConfig config = coslam::loopback_config(std::stoi(words.at(0)));
  config.key_file = words.at(1);
  coslam::lie_on(config, words.at(2));
}
