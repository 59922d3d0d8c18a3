// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/sync/clock_estimate.h"

#include <algorithm>
#include <cmath>

namespace coslam {
namespace {

constexpr double kMemory_s = 30;
constexpr double kLeastError_s = 0.0005;  // of an exchange: scheduling at both ends
constexpr double kUsualDrift = 1e-4;      // of quartz; more is believed when the exchanges say so
constexpr double kStep_s = 0.05;          // farther off than the time under way explains: the clock was set
constexpr int kStraysToBelieve = 2;

}  // namespace

void ClockEstimate::add(const ClockExchange& stamps) {
  constexpr TimeNs kLatest_ns = 4'000'000'000'000'000'000;  // differences stay in range
  const bool in_order = 0 <= stamps.sent_ns && stamps.sent_ns <= stamps.arrived_ns && 0 <= stamps.received_ns &&
                        stamps.received_ns <= stamps.replied_ns && stamps.replied_ns <= kLatest_ns;
  if (!in_order) return;
  const TimeNs round_trip_ns = (stamps.arrived_ns - stamps.sent_ns) - (stamps.replied_ns - stamps.received_ns);
  if (round_trip_ns < 0) return;
  if (samples_.empty()) {
    origin_ns_ = stamps.arrived_ns;
    offset_zero_ns_ = stamps.replied_ns - stamps.arrived_ns;
  }
  const TimeNs twice_ns = (stamps.received_ns - stamps.sent_ns - offset_zero_ns_) +
                          (stamps.replied_ns - stamps.arrived_ns - offset_zero_ns_);
  const Sample now{to_seconds(stamps.arrived_ns - origin_ns_), 0.5 * to_seconds(twice_ns), to_seconds(round_trip_ns)};
  if (const auto expected_s = predicted_s(now.at_s)) {
    const double off_s = std::abs(now.offset_s - *expected_s);
    strays_ = off_s > kStep_s + 0.5 * now.round_trip_s ? strays_ + 1 : 0;
    if (strays_ > 0 && strays_ < kStraysToBelieve) return;
    if (strays_ > 0) samples_.clear();
    strays_ = 0;
  }
  samples_.push_back(now);
  while (samples_.front().at_s < now.at_s - kMemory_s) samples_.pop_front();
}

// Weighted least squares about the mean time, the drift with a weak prior.
ClockEstimate::Line ClockEstimate::fit() const {
  const double least_s = std::ranges::min(samples_, {}, &Sample::round_trip_s).round_trip_s;
  const auto weight = [&](const Sample& s) {
    const double error_s = kLeastError_s + 0.5 * (s.round_trip_s - least_s);
    return 1 / (error_s * error_s);
  };
  double sum = 0;
  Line line;
  for (const Sample& s : samples_) {
    sum += weight(s);
    line.at_s += weight(s) * s.at_s;
    line.offset_s += weight(s) * s.offset_s;
  }
  line.at_s /= sum;
  line.offset_s /= sum;
  double information = 1 / (kUsualDrift * kUsualDrift), gradient = 0;
  for (const Sample& s : samples_) {
    information += weight(s) * (s.at_s - line.at_s) * (s.at_s - line.at_s);
    gradient += weight(s) * (s.at_s - line.at_s) * (s.offset_s - line.offset_s);
  }
  line.drift = gradient / information;
  return line;
}

std::optional<double> ClockEstimate::predicted_s(double at_s) const {
  if (samples_.size() < 3) return std::nullopt;
  const Line line = fit();
  return line.offset_s + line.drift * (at_s - line.at_s);
}

std::optional<double> ClockEstimate::offset_s(TimeNs server_ns) const {
  const auto predicted = predicted_s(to_seconds(server_ns - origin_ns_));
  if (!predicted || strays_ > 0) return std::nullopt;
  return to_seconds(offset_zero_ns_) + *predicted;
}

}  // namespace coslam
