// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/link/link_governor.h"

#include <algorithm>
#include <chrono>

namespace coslam {
namespace {

constexpr std::size_t kSentKept = 128;

}  // namespace

void LinkGovernor::sent(FrameId frame, Instant at, double delay_s, double sent_reply_bytes) {
  sent_.push_back({frame, at, delay_s, sent_reply_bytes});
  if (sent_.size() > kSentKept) sent_.pop_front();
}

LinkGovernor::Sent LinkGovernor::sent_with(FrameId frame, Instant now) const {
  const auto at = std::ranges::find(sent_, frame, &Sent::frame);
  return at == sent_.end() ? Sent{.frame = frame, .at = now} : *at;
}

std::optional<FrameId> LinkGovernor::newest_sent() const {
  return sent_.empty() ? std::nullopt : std::optional(sent_.back().frame);
}

double LinkGovernor::bytes_a_frame() const { return reply_rate_.bytes_per_s() * send_rate_.one_in() / rate_hz_; }

// From image to server it takes longer than at best for the link's sake, or the agent's own. Patches that come at once
// waited for one that was lost: the last of them tells how long the link takes.
ReplyLimits LinkGovernor::heard(const std::vector<MapPatch>& patches, bool replies_wait, bool server_alive,
                                Instant now) {
  constexpr double kWide_bytes_per_s = 25e3;  // of replies: frames take less
  constexpr std::chrono::seconds kWideAgain{20};
  std::optional<double> downlink_s;
  double wait_s = 0, round_s = 0;
  for (const MapPatch& p : patches) {
    if (p.sent_ns == 0) continue;
    const double took_s = to_seconds(p.received_ns - p.sent_ns);
    downlink_s = std::min(downlink_s.value_or(took_s), took_s);
    const Sent sent = sent_with(p.after_frame, now);
    wait_s = std::max(0.0, p.uplink_wait_s - sent.delay_s);
    round_s = std::chrono::duration<double>(now - sent.at).count();
    delivered_bytes_ = std::max(delivered_bytes_, sent.reply_bytes);
  }
  if (downlink_s) {
    // A link that was found to carry little is not taken for wide between two answers.
    if (replies_wait && reply_rate_.bytes_per_s() < kWide_bytes_per_s) full_ = now;
    const bool full = full_ && now - *full_ <= (reply_rate_.limited() ? kWideAgain : std::chrono::seconds(0));
    send_rate_.heard(wait_s, *downlink_s, full, now);
    reply_rate_.heard(wait_s, round_s, replies_wait, delivered_bytes_, now);
  }
  narrow_ = send_rate_.narrow() || reply_rate_.limited_since(now - kWideAgain);
  const ReplyLimits limits{.bytes_a_frame = bytes_a_frame(),
                           .up_to_bytes = delivered_bytes_ + reply_rate_.unanswered_bytes(),
                           .narrow_link = narrow_};
  if (server_alive) send_rate_.tick(now);
  return limits;
}

LinkGovernor::Room LinkGovernor::room() const {
  constexpr double kSeconds = 1, kBytesAFeature = 80, kBytesAPatch = 80;
  constexpr int kLeastFeatures = 140, kFewFeatures = 200;
  constexpr double kFewPatches = 4, kManyPatches = 16;
  const auto patches = static_cast<std::size_t>(std::clamp(bytes_a_frame() / kBytesAPatch, kFewPatches, kManyPatches));
  if (reply_rate_.limited()) {
    const double most = kSeconds * reply_rate_.bytes_per_s() / kBytesAFeature;
    return {patches, std::max(kLeastFeatures, static_cast<int>(std::min(most, 1e6)))};
  }
  if (send_rate_.narrow()) return {patches, kFewFeatures};
  return {};
}

}  // namespace coslam
