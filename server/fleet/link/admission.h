// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "common/model/session.h"
#include "common/wire/counters.h"

namespace coslam {

// Decides who may take part. One seat a name, held by one run: a run keeps its seat while it shows signs of life; when
// it is silent or gone, a new run of that name takes it over (a restart); while it lives, a second one is refused.
// Since a killed agent looks alive for a moment, a newcomer waits for `patience` before it is refused. Pure: time is an
// argument. Thread-compatible.
class Admission {
 public:
  explicit Admission(std::chrono::milliseconds patience) : patience_(patience) {}

  void hello(const Hello& hello, Instant now);
  void alive(RunId run);
  void silent(RunId run);
  void note_gone(RunId run);
  void tick(Instant now);
  void refuse(const std::string& agent, RunId run, const std::string& reason);

  // Runs that got a seat since the last call: new ones, restarts, and runs that came back after they were gone.
  std::vector<Hello> take_admitted();

  // Whether a sample may be used; a run that was gone is admitted again by it.
  std::optional<Rejection> check(const std::string& agent, RunId run);
  // The agent whose seat this run holds.
  const Hello* find(RunId run) const;
  bool present(RunId run) const;  // holds a seat and is not gone
  const std::vector<Refusal>& refused() const { return refused_; }

 private:
  enum class Life { kAlive, kSilent, kGone };
  struct Seat {
    Hello hello;
    Life life = Life::kAlive;
    std::optional<Hello> newcomer;
    Instant newcomer_since;
  };

  const Seat* seat_of(RunId run) const;
  Seat* seat_of(RunId run);
  bool make_room();
  void take_seat(Seat& seat, const Hello& hello);
  void fell_silent(RunId run, Life life);
  bool is_refused(RunId run) const;

  const std::chrono::milliseconds patience_;
  std::map<std::string, Seat> seats_;  // keyed by name
  std::vector<Refusal> refused_;       // the newest
  std::vector<Hello> admitted_;
};

}  // namespace coslam
