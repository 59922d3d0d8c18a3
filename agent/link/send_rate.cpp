// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/link/send_rate.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace coslam {
namespace {

constexpr double kLeastRate_hz = 10;
constexpr double kWindow_s = 0.4;  // of messages: what queues delays them all, what was lost and sent again only some
constexpr double kLate_s = 0.6, kSoon_s = 0.2;  // of waiting; an agent or server that is busy at the start takes less
constexpr double kLateFor_s = 1.2;              // a stall is no narrow link
constexpr double kTry_s = 5, kLateInTry_s = 0.25;  // a queue may fill slowly
constexpr double kFarTooLate_s = 1.2, kBetweenPauses_s = 10, kLongestPause_s = 2;
constexpr double kSilence_s = 3;                                                     // as bad as late
constexpr double kSettling_s = 1.5;                                                  // until fewer frames show
constexpr double kPatienceAtFirst_s = 0.4, kPatience_s = 2.5, kMostPatience_s = 60;  // of soon messages before a try
constexpr double kClockSet_s = 0.4;  // messages overtake each other by less
constexpr double kForget = 1e-4;     // of the least time, a message: clocks drift

double seconds(Instant from, Instant to) { return std::chrono::duration<double>(to - from).count(); }

}  // namespace

SendRate::SendRate(double rate_hz)
    : rate_hz_(rate_hz),
      most_(std::max(1, static_cast<int>(rate_hz / kLeastRate_hz))),
      one_in_(most_),
      patience_s_(kPatienceAtFirst_s) {}

bool SendRate::due(TimeNs capture_ns) {
  ++passed_;
  if (hold_until_ && now_ < *hold_until_) return false;
  const auto number = std::llround(to_seconds(capture_ns) * rate_hz_);
  if (number % one_in_ != 0 && passed_ < 2 * one_in_) return false;  // where frames are missing, do not wait for ever
  passed_ = 0;
  return true;
}

void SendRate::heard(double uplink_wait_s, double downlink_s, bool full, Instant now) {
  if (heard_ && least_downlink_s_) {
    // What is sent later comes at most as much later than the one before as time passed: the rest is a clock, set.
    const double set_s = downlink_s - downlink_s_ - seconds(*heard_, now);
    if (set_s > kClockSet_s) *least_downlink_s_ += set_s;
  }
  heard_ = now_ = now;
  downlink_s_ = downlink_s;
  least_downlink_s_ = least_downlink_s_ ? std::min(*least_downlink_s_ + kForget, downlink_s) : downlink_s;
  recent_.push_back({now, std::max(uplink_wait_s, downlink_s - *least_downlink_s_)});
  while (seconds(recent_.front().at, now) > kWindow_s) recent_.pop_front();
  // Nothing is sent again on the way up: in a try a few that waited tell enough.
  constexpr double kFewMessages_s = 0.15;
  constexpr std::size_t kFewMessages = 3;
  uplink_.push_back({now, uplink_wait_s});
  while (seconds(uplink_.front().at, now) > kFewMessages_s) uplink_.pop_front();
  const double up_s = std::ranges::min(uplink_, {}, &Waited::wait_s).wait_s;
  if (trying(now) && uplink_.size() >= kFewMessages && up_s > kLateInTry_s) send_fewer(up_s, now);
  const double wait_s = std::ranges::min(recent_, {}, &Waited::wait_s).wait_s;
  // A link that was cut is as it was before.
  if (before_silence_ && wait_s <= kSoon_s) one_in_ = *before_silence_;
  before_silence_.reset();
  waited(wait_s, full, now);
}

void SendRate::tick(Instant now) {
  now_ = now;
  if (!heard_) heard_ = now;
  if (seconds(*heard_, now) <= kSilence_s) return;
  if (!before_silence_) before_silence_ = one_in_;
  waited(kSilence_s, false, now);
}

void SendRate::waited(double wait_s, bool full, Instant now) {
  if (wait_s <= kLate_s) late_since_.reset();
  if (wait_s > kLate_s && !late_since_) late_since_ = now;
  const bool soon = wait_s <= kSoon_s && !(full && narrow());
  if (!soon) soon_since_.reset();
  if (soon && !soon_since_) soon_since_ = now;
  if (trying(now) && wait_s > kLateInTry_s) return send_fewer(wait_s, now);
  if (fewer_ && seconds(*fewer_, now) < kSettling_s) return;
  const bool late = late_since_ && seconds(*late_since_, now) > kLateFor_s;
  if (late && wait_s > kFarTooLate_s && wait_s < kSilence_s && most_ > 1 &&
      (!held_ || seconds(*held_, now) > kBetweenPauses_s)) {
    held_ = now;
    hold_until_ = now + std::chrono::duration_cast<Instant::duration>(
                            std::chrono::duration<double>(std::min(wait_s, kLongestPause_s)));
  }
  if (late && one_in_ < most_) return send_fewer(wait_s, now);
  if (one_in_ == 1 || !soon_since_) return;
  const Instant start = std::max({*soon_since_, tried_.value_or(*soon_since_), fewer_.value_or(*soon_since_)});
  if (seconds(start, now) <= patience_s_) return;
  before_try_ = one_in_;
  --one_in_;  // a narrow link is found at the first step, before a queue is long
  tried_ = now;
}

bool SendRate::trying(Instant now) const { return tried_ && seconds(*tried_, now) < kTry_s; }

void SendRate::send_fewer(double wait_s, Instant now) {
  patience_s_ = std::clamp(2 * patience_s_, kPatience_s, kMostPatience_s);
  one_in_ = wait_s > kFarTooLate_s ? most_ : std::min(std::max(one_in_ + 1, trying(now) ? before_try_ : 1), most_);
  tried_.reset();
  fewer_ = now;
}

}  // namespace coslam
