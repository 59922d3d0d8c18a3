// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/sync/frame_set_sync.h"

#include <algorithm>
#include <utility>

namespace coslam {
namespace {

constexpr double kForget = 0.1;                // of a second, each second
constexpr TimeNs kLongest_ns = 1'000'000'000;  // an agent that is later than the others by more is not waited for

}  // namespace

void FrameSetSync::add(CameraId camera, double rate_hz, bool lockstep) {
  Member& m = members_[camera];
  m = {};
  m.lockstep = lockstep;
  m.period_ns = to_ns(1.0 / rate_hz);
}

void FrameSetSync::finish(CameraId camera) {
  const auto at = members_.find(camera);
  if (at != members_.end()) at->second.finished = true;
}

void FrameSetSync::set_silent(CameraId camera) {
  const auto at = members_.find(camera);
  if (at != members_.end()) at->second.silent = true;
}

bool FrameSetSync::push(CameraFrame frame, TimeNs now_ns) {
  const auto at = members_.find(frame.camera);
  if (at == members_.end()) return false;
  Member& m = at->second;
  m.silent = false;
  const TimeNs lag_ns = now_ns - frame.frame.capture_ns;
  const auto forgotten_ns = static_cast<TimeNs>(kForget * static_cast<double>(now_ns - m.lag_at_ns));
  m.lag_ns = m.lag_at_ns == 0 ? lag_ns : std::max(lag_ns, m.lag_ns - forgotten_ns);
  m.lag_at_ns = now_ns;
  if (last_t_ns_ && frame.frame.capture_ns < *last_t_ns_ - tolerance_ns(m.period_ns)) {
    ++late_;
    return false;
  }
  m.queue.push_back({std::move(frame), now_ns});
  if (!m.lockstep && static_cast<int>(m.queue.size()) > config_.queue_frames) {
    m.queue.pop_front();
    ++overflowed_;
  }
  return true;
}

std::vector<CameraId> FrameSetSync::blocking() const {
  std::vector<CameraId> out;
  for (const auto& [id, m] : members_) {
    if (m.queue.empty() && !m.finished && !m.silent) out.push_back(id);
  }
  return out;
}

// Whether nobody else is to be waited for. since_ns: when the first of them arrived.
bool FrameSetSync::overdue(const Waiting& oldest, TimeNs since_ns, TimeNs now_ns) const {
  const TimeNs deadline_ns = to_ns(config_.deadline_s);
  return std::ranges::all_of(blocking(), [&](const CameraId id) {
    const Member& m = members_.at(id);
    if (m.lockstep) return false;
    // One whose clock or link is behind the others' is late by as much, and no more.
    const TimeNs usual_ns = m.lag_at_ns == 0 ? since_ns : oldest.frame.frame.capture_ns + m.lag_ns;
    return now_ns - std::clamp(usual_ns, since_ns, since_ns + kLongest_ns) > deadline_ns;
  });
}

TimeNs FrameSetSync::tolerance_ns(TimeNs period_ns) const {
  return static_cast<TimeNs>(config_.tolerance_frames * static_cast<double>(period_ns));
}

// Its period is the median of the last steps: frames that were lost or thinned out are no other camera. Of frames that
// are used, so that in lock-step it does not matter which agent is ahead.
CameraFrame FrameSetSync::take_head(Member& m) {
  constexpr std::size_t kSteps = 15, kLeastSteps = 5;
  CameraFrame frame = std::move(m.queue.front().frame);
  m.queue.pop_front();
  const TimeNs t_ns = frame.frame.capture_ns;
  if (m.newest_ns && t_ns > *m.newest_ns) m.steps_ns.push_back(t_ns - *m.newest_ns);
  m.newest_ns = t_ns;
  if (m.steps_ns.size() > kSteps) m.steps_ns.pop_front();
  if (m.steps_ns.size() < kLeastSteps) return frame;
  std::vector<TimeNs> sorted(m.steps_ns.begin(), m.steps_ns.end());
  const auto middle = sorted.begin() + std::ssize(sorted) / 2;
  std::ranges::nth_element(sorted, middle);
  m.period_ns = *middle;
  return frame;
}

// Takes the frames that are of the instant of the oldest one; ascending cameras.
std::vector<CameraFrame> FrameSetSync::take_instant(TimeNs first_ns) {
  std::vector<std::pair<TimeNs, Member*>> heads;
  for (auto& [id, m] : members_) {
    if (!m.queue.empty()) heads.emplace_back(m.queue.front().frame.frame.capture_ns - first_ns, &m);
  }
  std::ranges::stable_sort(heads, {}, &std::pair<TimeNs, Member*>::first);
  std::vector<CameraFrame> out;
  TimeNs least_period_ns = std::numeric_limits<TimeNs>::max();
  for (const auto& [after_ns, m] : heads) {
    const TimeNs period_ns = std::min(least_period_ns, m->period_ns);
    if (after_ns > tolerance_ns(period_ns)) continue;
    least_period_ns = period_ns;
    out.push_back(take_head(*m));
  }
  std::ranges::sort(out, {}, &CameraFrame::camera);
  return out;
}

std::optional<FrameSet> FrameSetSync::pop(TimeNs now_ns) {
  const Waiting* oldest = nullptr;
  TimeNs waiting_since_ns = now_ns;
  for (const auto& [id, m] : members_) {
    if (m.queue.empty()) continue;
    const Waiting& head = m.queue.front();
    if (oldest == nullptr || head.frame.frame.capture_ns < oldest->frame.frame.capture_ns) oldest = &head;
    waiting_since_ns = std::min(waiting_since_ns, head.arrived_ns);
  }
  if (oldest == nullptr || !overdue(*oldest, waiting_since_ns, now_ns)) return std::nullopt;

  FrameSet set;
  set.id = SetId(next_set_++);
  const TimeNs first_ns = oldest->frame.frame.capture_ns;
  set.frames = take_instant(first_ns);
  TimeNs sum_ns = 0;
  for (const CameraFrame& f : set.frames) sum_ns += f.frame.capture_ns - first_ns;
  set.t_ns = std::max(last_set_ns_, first_ns + sum_ns / static_cast<TimeNs>(set.frames.size()));
  last_set_ns_ = set.t_ns;
  last_t_ns_ = first_ns;
  return set;
}

}  // namespace coslam
