// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/sync/set_clock.h"

#include <utility>

namespace coslam {

void SetClock::add(CameraId camera, const Hello& hello) {
  const bool waits = hello.pacing == Pacing::kLockstep;
  lockstep_ |= waits;
  sync_.add(camera, hello.rate_hz, waits);
  stamps_.add(camera, hello.agent, hello.rate_hz);
}

void SetClock::set_silent(CameraId camera) {
  if (!lockstep_) sync_.set_silent(camera);
}

bool SetClock::date(CameraFrame* frame, TimeNs arrived_ns) {
  if (lockstep_) return true;
  const auto taken_ns = stamps_.place(frame->camera, frame->frame.capture_ns, arrived_ns);
  if (taken_ns) frame->frame.capture_ns = *taken_ns;
  return taken_ns.has_value();
}

SetClock::Pushed SetClock::push(CameraFrame frame, TimeNs now_ns) {
  const std::uint32_t overflowed = sync_.overflowed();
  const bool in_time = sync_.push(std::move(frame), now_ns);
  return {in_time, sync_.overflowed() > overflowed};
}

std::optional<FrameSet> SetClock::next(TimeNs now_ns, std::size_t most,
                                       const std::function<void(const FrameSet&)>& leave_out) {
  if (lockstep_) return sync_.pop(now_ns);
  while (auto set = sync_.pop(now_ns)) backlog_.push(std::move(*set));
  for (const FrameSet& set : backlog_.thin(most)) {
    leave_out(set);
    ++left_out_;
  }
  return backlog_.pop();
}

}  // namespace coslam
