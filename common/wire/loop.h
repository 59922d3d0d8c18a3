// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "common/wire/participant.h"

namespace coslam {

// Names one writer somewhere in the domain; a restarted process has new ones.
struct WriterId {
  std::array<std::uint8_t, 16> guid{};
  friend auto operator<=>(const WriterId&, const WriterId&) = default;
};

enum class Presence : std::uint8_t {
  kAlive,   // matched, or heard again after silence
  kSilent,  // no sign of life for WireConfig::silent_after_s
  kGone,    // ended, or unheard for WireConfig::lease_s
};

// Where a sample came from and what it cost.
struct Sample {
  WriterId writer;
  std::uint64_t bytes = 0;
};

// One thread that waits for samples and for changes of presence of any number of topics and hands them on, the samples
// that came before a change of presence before it. The middleware's own threads only leave a note; all work is done
// here.
class Loop {
 public:
  template <class Message>
  using OnSample = std::function<void(const Message&, const Sample&)>;
  using OnPresence = std::function<void(const WriterId&, Presence)>;

  // on_tick is called about every `tick`, also when nothing arrives.
  Loop(Participant& participant, std::string name, std::chrono::milliseconds tick, std::function<void()> on_tick);
  ~Loop();  // stops; no handler runs afterwards
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;

  // Before start().
  template <class Message>
  void read(OnSample<Message> on_sample, OnPresence on_presence = {}, const std::string& partition = {});
  void start();

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace coslam
