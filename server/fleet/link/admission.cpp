// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/link/admission.h"

#include <algorithm>
#include <utility>

#include "idl/coslam.h"

namespace coslam {
namespace {

// Fit to be sent: one line, not too long, not empty.
std::string sentence(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return text.empty() ? "refused by the server" : text.substr(0, 200);
}

std::string protocol_mismatch(const Hello& hello) {
  return "agent '" + hello.agent + "' speaks protocol " + std::to_string(hello.protocol) + " and the server protocol " +
         std::to_string(kProtocolVersion) + ": install the same version on both";
}

}  // namespace

void Admission::hello(const Hello& hello, Instant now) {
  if (is_refused(hello.agent_run)) return;
  if (hello.protocol != kProtocolVersion) return refuse(hello.agent, hello.agent_run, protocol_mismatch(hello));
  auto found = seats_.find(hello.agent);
  if (found == seats_.end()) {
    if (!make_room()) {
      return refuse(hello.agent, hello.agent_run, "the server has no room for more agents");
    }
    return take_seat(seats_[hello.agent], hello);
  }
  Seat& holder = found->second;
  if (holder.hello.agent_run == hello.agent_run) {
    if (holder.life == Life::kGone) take_seat(holder, hello);
    return;
  }
  if (holder.life != Life::kAlive) return take_seat(holder, hello);
  holder.newcomer = hello;
  holder.newcomer_since = now;
}

void Admission::take_seat(Seat& seat, const Hello& hello) {
  const RunId before = seat.hello.agent_run;
  seat = {hello, Life::kAlive, std::nullopt, {}};
  if (before.value != 0 && before != hello.agent_run) {
    refuse(hello.agent, before, "another agent named '" + hello.agent + "' took over while this one was silent");
  }
  admitted_.push_back(hello);
}

void Admission::alive(RunId run) {
  if (Seat* seat = seat_of(run); seat != nullptr && seat->life == Life::kSilent) seat->life = Life::kAlive;
}

void Admission::silent(RunId run) { fell_silent(run, Life::kSilent); }
void Admission::note_gone(RunId run) { fell_silent(run, Life::kGone); }

void Admission::fell_silent(RunId run, Life life) {
  Seat* holder = seat_of(run);
  if (holder == nullptr) return;
  holder->life = life;
  if (holder->newcomer) take_seat(*holder, Hello(*holder->newcomer));
}

void Admission::tick(Instant now) {
  for (auto& [name, seat] : seats_) {
    if (!seat.newcomer || now - seat.newcomer_since < patience_) continue;
    refuse(name, seat.newcomer->agent_run, "the name '" + name + "' is taken by a running agent");
    seat.newcomer.reset();
  }
}

void Admission::refuse(const std::string& agent, RunId run, const std::string& reason) {
  if (refused_.size() == idl::MAX_REFUSALS) refused_.erase(refused_.begin());
  refused_.push_back({run, sentence(reason)});
  const auto seat = seats_.find(agent);
  if (seat != seats_.end() && seat->second.hello.agent_run == run) seats_.erase(seat);
}

std::vector<Hello> Admission::take_admitted() { return std::exchange(admitted_, {}); }

std::optional<Rejection> Admission::check(const std::string& agent, RunId run) {
  const auto found = seats_.find(agent);
  if (is_refused(run)) return Rejection::kWrongRun;
  if (found == seats_.end()) return Rejection::kUnknownAgent;
  Seat& holder = found->second;
  if (holder.hello.agent_run != run) {
    return seat_of(run) == nullptr ? Rejection::kUnknownAgent : Rejection::kWrongRun;
  }
  if (holder.life == Life::kGone) take_seat(holder, Hello(holder.hello));
  holder.life = Life::kAlive;
  return std::nullopt;
}

const Hello* Admission::find(RunId run) const {
  const Seat* seat = seat_of(run);
  return seat == nullptr ? nullptr : &seat->hello;
}

bool Admission::present(RunId run) const {
  const Seat* seat = seat_of(run);
  return seat != nullptr && seat->life != Life::kGone;
}

const Admission::Seat* Admission::seat_of(RunId run) const {
  const auto found = std::ranges::find_if(seats_, [run](const auto& s) { return s.second.hello.agent_run == run; });
  return found == seats_.end() ? nullptr : &found->second;
}

Admission::Seat* Admission::seat_of(RunId run) { return const_cast<Seat*>(std::as_const(*this).seat_of(run)); }

// For one more name; the seats of agents that are gone are kept until then.
bool Admission::make_room() {
  if (seats_.size() < idl::MAX_AGENTS) return true;
  const auto empty = std::ranges::find_if(seats_, [](const auto& s) { return s.second.life == Life::kGone; });
  if (empty == seats_.end()) return false;
  seats_.erase(empty);
  return true;
}

bool Admission::is_refused(RunId run) const {
  return std::ranges::any_of(refused_, [run](const Refusal& r) { return r.agent_run == run; });
}

}  // namespace coslam
