// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/record/recorded_link.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "common/flow/clock.h"

namespace coslam {

RecordedLink::RecordedLink(const std::filesystem::path& file, double rate)
    : recording_(file), rate_(rate), opened_ns_(monotonic_now_ns()), next_(recording_.next()) {}

TimeNs RecordedLink::now_ns() const {
  if (rate_ == 0) return stepped_ns_;
  return static_cast<TimeNs>(rate_ * static_cast<double>(monotonic_now_ns() - opened_ns_));
}

bool RecordedLink::over() const { return !next_ && now_ns() >= due_ns(); }

std::optional<ServerEvent> RecordedLink::next_event(std::chrono::milliseconds timeout) {
  if (now_ns() < due_ns()) wait(std::chrono::nanoseconds(timeout).count());
  if (!next_ || now_ns() < next_->t_ns) return std::nullopt;
  ServerEvent event = std::move(next_->event);
  next_ = recording_.next();
  return event;
}

// Until something is due, and at most so long.
void RecordedLink::wait(TimeNs longest_ns) {
  const TimeNs left_ns = due_ns() - now_ns();
  if (rate_ == 0) {
    stepped_ns_ += std::min(left_ns, longest_ns);
    return;
  }
  const auto real_ns = static_cast<TimeNs>(static_cast<double>(left_ns) / rate_) + 1;
  std::this_thread::sleep_for(std::chrono::nanoseconds(std::min(real_ns, longest_ns)));
}

}  // namespace coslam
