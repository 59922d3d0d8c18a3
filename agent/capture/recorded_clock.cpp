// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/recorded_clock.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "agent/capture/stamps.h"
#include "common/base/text.h"

namespace coslam {
namespace {

// Images a second, as a whole number where there are many; 0: no two times differ.
double rate_hz(std::vector<TimeNs> times_ns) {
  constexpr TimeNs kSecond_ns = 1'000'000'000;
  std::ranges::sort(times_ns);
  std::vector<WrittenTime> written_s;
  for (const TimeNs t_ns : times_ns) {
    const TimeNs part_ns = (t_ns % kSecond_ns + kSecond_ns) % kSecond_ns;
    written_s.push_back({t_ns / kSecond_ns - (t_ns % kSecond_ns < 0 ? 1 : 0), part_ns});
  }
  const auto interval_s = usual_interval(written_s);
  const double rate_hz = interval_s ? 1 / *interval_s : 0;
  return rate_hz > 2 ? std::round(rate_hz) : rate_hz;
}

// Why the stamps do not count; empty: they do.
std::string why_not(const std::vector<RecordedTime>& first) {
  std::vector<TimeNs> stamps_ns, noted_ns;
  for (const RecordedTime& t : first) {
    if (t.stamp_ns != 0) stamps_ns.push_back(t.stamp_ns);
    noted_ns.push_back(t.noted_ns);
  }
  if (2 * stamps_ns.size() <= first.size()) return "most of its images have no stamp";
  const double by_stamps_hz = rate_hz(stamps_ns), by_noted_hz = rate_hz(noted_ns);
  if (!is_rate_of_camera(by_noted_hz)) return {};
  std::vector<TimeNs> distinct_ns = stamps_ns;
  std::ranges::sort(distinct_ns);
  distinct_ns.erase(std::unique(distinct_ns.begin(), distinct_ns.end()), distinct_ns.end());
  if (2 * distinct_ns.size() < stamps_ns.size()) return "most of its images have the stamp of another";
  if (is_rate_of_camera(by_stamps_hz)) return {};
  return "by their stamps its images would come " + format_double(by_stamps_hz) +
         " times a second, and were received " + format_double(by_noted_hz) + " times a second";
}

}  // namespace

RecordedClock recorded_clock(const std::string& name, const std::vector<RecordedTime>& first, TimeNs recording_ns) {
  constexpr double kOneClock_s = 10, kUnderWay_s = 0.1;  // from its stamp until it was noted
  constexpr std::size_t kFew = 4;                        // that may come in another order
  RecordedClock clock;
  clock.zero_ns = recording_ns - to_ns(kUnderWay_s);
  if (first.empty()) return clock;
  if (const std::string why = why_not(first); !why.empty()) {
    clock.by_stamps = false;
    clock.guesses.push_back(name + ": " + why + "; the times at which they were received count");
  } else {
    std::vector<RecordedTime> stamped;
    std::ranges::copy_if(first, std::back_inserter(stamped), [](const RecordedTime& t) { return t.stamp_ns != 0; });
    if (std::abs(to_seconds(stamped[0].stamp_ns) - to_seconds(stamped[0].noted_ns)) >= kOneClock_s) {
      stamped.resize(std::min(stamped.size(), kFew));
      clock.zero_ns = std::ranges::min(stamped, {}, &RecordedTime::stamp_ns).stamp_ns;
    }
  }
  std::vector<std::optional<TimeNs>> source_ns;
  for (const RecordedTime& t : first) {
    if (!clock.by_stamps || t.stamp_ns != 0) source_ns.emplace_back(clock.source_ns(t));
  }
  std::ranges::sort(source_ns);
  if (const std::string bursts = said_of_bursts(name, source_ns); !bursts.empty()) clock.guesses.push_back(bursts);
  return clock;
}

}  // namespace coslam
