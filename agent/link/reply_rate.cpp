// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/link/reply_rate.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace coslam {
namespace {

constexpr double kLeast_bytes_per_s = 4e3, kMost_bytes_per_s = 10e6;  // the middleware has its own pace above
constexpr double kIdleBelow_s = 0.1, kCongestedAbove_s = 0.3;
constexpr double kDoubledAtFirst_s = 0.2, kDoubledIn_s = 2.0;
constexpr double kReplySettling_s = 0.6;  // until a change shows
constexpr double kForget_s = 1e-4;        // of the least round, a message

}  // namespace

void ReplyRate::heard(double uplink_wait_s, double round_s, bool replies_wait, double delivered_bytes, Instant now) {
  least_round_s_ = least_round_s_ ? std::min(*least_round_s_ + kForget_s, round_s) : round_s;
  const double since_s = heard_ ? std::chrono::duration<double>(now - *heard_).count() : 0;
  heard_ = now;
  if (uplink_wait_s > kCongestedAbove_s) {
    if (halved_ && now - *halved_ < std::chrono::duration<double>(kReplySettling_s)) return;
    // It grew fast until now and is far above what the link carries; from now on more is tried slowly.
    const double share = halved_ ? 0.5 : 0.125;
    halved_ = now;
    bytes_per_s_ = std::max(kLeast_bytes_per_s, share * bytes_per_s_);
  } else if (uplink_wait_s < kIdleBelow_s && replies_wait) {
    const double doubled_in_s = halved_ ? kDoubledIn_s : kDoubledAtFirst_s;
    bytes_per_s_ = std::min(kMost_bytes_per_s, bytes_per_s_ * std::exp2(std::min(since_s / doubled_in_s, 1.0)));
  }
  if (replies_wait) {
    note_delivered(delivered_bytes, now);
  } else {
    delivered_.clear();  // who sends little sees little arrive
  }
}

double ReplyRate::unanswered_bytes() const {
  constexpr double kQueue_s = 0.05, kAlways = 3e3;
  return (kQueue_s + least_round_s_.value_or(0)) * bytes_per_s_ + kAlways;
}

void ReplyRate::note_delivered(double bytes, Instant now) {
  constexpr double kWindow_s = 0.25, kAhead = 2;
  constexpr double kForgottenIn_s = 1;  // half of the most that arrived: where words are lost, some windows tell little
  delivered_.push_back({now, bytes});
  const auto ago_s = [&](std::size_t i) { return std::chrono::duration<double>(now - delivered_[i].at).count(); };
  while (delivered_.size() > 2 && ago_s(1) >= kWindow_s) delivered_.pop_front();
  if (ago_s(0) < kWindow_s) return;
  const double since_s = std::chrono::duration<double>(now - delivered_[delivered_.size() - 2].at).count();
  arrive_bytes_per_s_ = std::max(arrive_bytes_per_s_ * std::exp2(-since_s / kForgottenIn_s),
                                 (bytes - delivered_.front().bytes) / ago_s(0));
  bytes_per_s_ = std::min(bytes_per_s_, kAhead * arrive_bytes_per_s_ + kAtFirst_bytes_per_s);
}

}  // namespace coslam
