// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/sync/stamp_watch.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace coslam {
namespace {

constexpr TimeNs kFarthest_ns = 4'000'000'000'000'000'000;  // the year 2096: sums and differences stay in range
constexpr double kAlike_s = 1.0;                            // difference of lags that links explain
constexpr double kLikeClock_s = 2.0;
constexpr double kAhead_s = 0.5;    // less lag than ever by so much: no link does that
constexpr double kBehind_s = 2.5;   // more lag than ever by so much, steadily: longer than links queue
constexpr double kRecent_s = 1.0;   // a lag heard of so long ago still tells
constexpr double kSteady_s = 0.25;  // spread of lags of a clock that was set once
constexpr double kLookAhead_s = 1.0, kLookBehind_s = 2.0;  // how long to look at lags before they are believed
constexpr std::size_t kLeastLags = 5;
constexpr double kNoTimes_s = 3.0;  // of unsteady lags
constexpr double kForgetShare = 0.1, kDrift = 1e-3, kAnyFall = 1e9;
constexpr double kWorthCorrecting_s = 0.001, kWorthSaying_s = 0.02;

std::string in_words(double seconds) {
  char text[48];
  const double size = std::abs(seconds);
  std::snprintf(text, sizeof text, size < 1 ? "%.0f ms %s" : "%.1f s %s", size < 1 ? 1000 * size : size,
                seconds < 0 ? "ahead of" : "behind");
  return text;
}

}  // namespace

void StampWatch::Floor::add(double value_s, double now_s, double most_rise, double most_fall) {
  const double passed_s = now_s - at_s;
  least_s = least_s ? std::clamp(value_s, *least_s - most_fall * passed_s, *least_s + most_rise * passed_s) : value_s;
  at_s = now_s;
}

void StampWatch::add(CameraId camera, const std::string& name, double rate_hz) {
  constexpr double kDensest = 0.45;                         // of the period: twice the rate, with some jitter
  constexpr double kUsualRate_hz = 30, kMostRate_hz = 240;  // of a camera whose own was told too low, or too high
  agents_[camera] = {
      .name = name,
      .least_step_ns = std::max<TimeNs>(1, to_ns(kDensest / std::clamp(rate_hz, kUsualRate_hz, kMostRate_hz)))};
}

// The lower median of those heard lately.
std::optional<double> StampWatch::lag_of_others(CameraId camera, double now_s) const {
  std::vector<double> lags_s;
  for (const auto& [id, a] : agents_) {
    if (id != camera && a.trusted && now_s - a.heard_s < kRecent_s) lags_s.push_back(a.lag_s);
  }
  if (lags_s.empty()) return std::nullopt;
  const auto middle = lags_s.begin() + static_cast<std::ptrdiff_t>((lags_s.size() - 1) / 2);
  std::ranges::nth_element(lags_s, middle);
  return *middle;
}

// Of a frame that comes at once and is dated by the server's own clock.
double StampWatch::clock_lag_near(double lag_s) const {
  double nearest_s = -to_seconds(expected_ns_.front());
  for (const TimeNs at_zero_ns : expected_ns_) {
    const double candidate_s = -to_seconds(at_zero_ns);
    if (std::abs(candidate_s - lag_s) < std::abs(nearest_s - lag_s)) nearest_s = candidate_s;
  }
  return nearest_s;
}

bool StampWatch::is_by_clock(double lag_s) const { return std::abs(lag_s - clock_lag_near(lag_s)) <= kLikeClock_s; }

// What the lag should be, the nearest to what it is.
double StampWatch::expected_lag_s(const Agent& agent, std::optional<double> others_s, double lag_s) const {
  if (others_s) {
    // A slow link may become as fast as those of others.
    const double least_s = agent.trusted ? agent.beside_others.least_s.value_or(0) : 0;
    return *others_s + std::clamp(lag_s - *others_s, std::min(0.0, least_s), std::max(0.0, least_s));
  }
  if (agent.trusted) return agent.alone.least_s.value_or(lag_s);
  return clock_lag_near(lag_s);
}

bool StampWatch::fits(const Agent& agent, std::optional<double> others_s, double lag_s) const {
  const double late_s = lag_s - expected_lag_s(agent, others_s, lag_s);
  if (!agent.trusted && others_s) return std::abs(late_s) <= kAlike_s;
  if (!agent.trusted) return is_by_clock(lag_s);
  // Soon beside others whose links are slow just now, but no sooner than ever, is as it should be.
  if (late_s < -kAhead_s && lag_s < agent.ever.least_s.value_or(lag_s) - kAhead_s) return false;
  return !others_s || late_s <= kBehind_s;
}

// Whether the frames held back say that the clock was set, and by how much.
bool StampWatch::correct(Agent& agent, std::optional<double> others_s, double lag_s, double now_s) {
  agent.held.push_back({lag_s, now_s});
  const double expected_s = expected_lag_s(agent, others_s, lag_s);
  const double look_s = lag_s < expected_s ? kLookAhead_s : kLookBehind_s;
  while (now_s - agent.held.front().now_s > kNoTimes_s) agent.held.pop_front();
  std::vector<double> lags_s;
  for (const Held& h : agent.held) {
    if (now_s - h.now_s <= look_s) lags_s.push_back(h.lag_s);
  }
  const double held_s = now_s - agent.held.front().now_s;
  if (held_s < look_s || lags_s.size() < kLeastLags) return false;
  const auto [least, most] = std::ranges::minmax(lags_s);
  if (most - least > kSteady_s) {
    if (least > expected_s && !agent.trusted) return true;  // a slow link, and nobody else is hurt by late frames
    if (held_s > 0.9 * kNoTimes_s && !std::exchange(agent.warned, true)) {
      warnings_.push_back("the stamps of agent " + agent.name +
                          " do not run with time: its frames are not used until they do");
    }
    return false;
  }
  const double by_s = least - expected_s;
  agent.correction_ns += to_ns(by_s);
  agent.held.clear();
  agent.warned = false;
  say_corrected(agent, by_s);
  return true;
}

void StampWatch::say_corrected(const Agent& agent, double by_s) {
  if (std::abs(by_s) < kWorthSaying_s) return;
  warnings_.push_back("the clock of agent " + agent.name + " is " + in_words(by_s) +
                      " the server's: its stamps are corrected; set its clock");
}

void StampWatch::exchange(CameraId camera, const ClockExchange& stamps) {
  const auto at = agents_.find(camera);
  if (at == agents_.end()) return;
  Agent& agent = at->second;
  agent.clock.add(stamps);
  const auto offset_s = agent.clock.offset_s(stamps.arrived_ns);
  if (!offset_s || !agent.trusted) return;
  // The server's time may begin anywhere: what an agent's clock is ahead of it is what the expected stamps are.
  const double ahead_s = *offset_s - to_seconds(expected_ns_.front());
  const double by_s = -ahead_s - to_seconds(agent.correction_ns);
  if (std::abs(by_s) < kWorthCorrecting_s) return;
  agent.correction_ns += to_ns(by_s);
  agent.lag_s -= by_s;
  for (Floor* f : {&agent.alone, &agent.beside_others, &agent.ever}) {
    if (f->least_s) *f->least_s -= by_s;
  }
  say_corrected(agent, by_s);
}

std::optional<TimeNs> StampWatch::place(CameraId camera, TimeNs capture_ns, TimeNs now_ns) {
  const auto at = agents_.find(camera);
  if (at == agents_.end()) return std::nullopt;
  Agent& agent = at->second;
  const auto refuse = [&] {
    ++refused_;
    return std::nullopt;
  };
  if (capture_ns < -kFarthest_ns || capture_ns > kFarthest_ns) {
    if (!std::exchange(agent.warned, true)) {
      warnings_.push_back("the stamps of agent " + agent.name + " are no times: its frames are not used");
    }
    return refuse();
  }
  const double now_s = to_seconds(now_ns);
  const auto lag_now_s = [&] { return to_seconds(now_ns - (capture_ns + agent.correction_ns)); };
  const auto others_s = lag_of_others(camera, now_s);
  if (!fits(agent, others_s, lag_now_s()) && !correct(agent, others_s, lag_now_s(), now_s)) return refuse();
  agent.held.clear();
  const double lag_s = lag_now_s();
  const TimeNs t_ns = capture_ns + agent.correction_ns;
  agent.trusted = true;
  agent.lag_s = lag_s;
  agent.heard_s = now_s;
  // Recordings may play faster than time.
  agent.alone.add(lag_s, now_s, kForgetShare, kAnyFall);
  agent.ever.add(lag_s, now_s, kDrift, kForgetShare);
  if (others_s) agent.beside_others.add(lag_s - *others_s, now_s, kForgetShare, kForgetShare);
  if (agent.newest_ns && t_ns < *agent.newest_ns + agent.least_step_ns) return refuse();
  agent.newest_ns = t_ns;
  return t_ns;
}

double StampWatch::wait_s(CameraId camera) const {
  const auto at = agents_.find(camera);
  if (at == agents_.end() || !at->second.alone.least_s) return 0;
  return std::max(0.0, at->second.lag_s - *at->second.alone.least_s);
}

TimeNs StampWatch::correction_ns(CameraId camera) const {
  const auto at = agents_.find(camera);
  return at == agents_.end() ? 0 : at->second.correction_ns;
}

}  // namespace coslam
