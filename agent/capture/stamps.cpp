// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/stamps.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "common/base/error.h"
#include "common/base/text.h"

namespace coslam {
namespace {

constexpr std::int64_t kBillion = 1'000'000'000;
constexpr double kDates_s = 1e8, kDatesEnd_s = 1e10;  // since 1970: 1973 to 2286

struct Unit {
  const char* name;
  std::int64_t per_second;
};
constexpr std::array<Unit, 4> kUnits = {
    {{"seconds", 1}, {"milliseconds", 1'000}, {"microseconds", 1'000'000}, {"nanoseconds", kBillion}}};

std::string short_number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

bool only_digits(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

// Up to as many that no difference between two of them is too large.
std::optional<std::int64_t> digits(std::string_view text) {
  constexpr std::int64_t kMost = 4'000'000'000'000'000'000;
  if (text.empty() || !only_digits(text)) return std::nullopt;
  const auto value = parse_integer(text);
  return value && *value <= kMost ? value : std::nullopt;
}

// The part behind the point.
std::optional<std::int64_t> billionths_of(std::string_view part) {
  if (!only_digits(part)) return std::nullopt;
  std::string nine(part.substr(0, 9));
  nine.resize(9, '0');
  return digits(nine).value_or(0) + (part.size() > 9 && part[9] >= '5' ? 1 : 0);
}

WrittenTime normalised(std::int64_t whole, std::int64_t billionths) {
  if (billionths >= kBillion) ++whole, billionths -= kBillion;
  if (billionths < 0) --whole, billionths += kBillion;
  return {whole, billionths};
}

std::optional<WrittenTime> parse_date(std::string_view text) {
  const auto fields = split_fields(text, " \tT-:Z");
  if (fields.size() != 6 || text.size() < 19 || text[4] != '-') return std::nullopt;
  std::array<std::int64_t, 5> n{};
  for (std::size_t i = 0; i < n.size(); ++i) {
    const auto value = digits(fields[i]);
    if (!value) return std::nullopt;
    n[i] = *value;
  }
  const std::chrono::year_month_day day(std::chrono::year(static_cast<int>(n[0])),
                                        std::chrono::month(static_cast<unsigned>(n[1])),
                                        std::chrono::day(static_cast<unsigned>(n[2])));
  const auto second = parse_written_time(fields[5]);
  const bool ok = n[0] < 10'000 && day.ok() && n[3] < 24 && n[4] < 60 && second && second->whole >= 0;
  if (!ok || second->whole > 60) return std::nullopt;
  const std::int64_t days = std::chrono::sys_days(day).time_since_epoch().count();
  return WrittenTime{((days * 24 + n[3]) * 60 + n[4]) * 60 + second->whole, second->billionths};
}

// Later than `first`, which is not later.
double units_since(const WrittenTime& t, const WrittenTime& first) {
  return static_cast<double>(t.whole - first.whole) + 1e-9 * static_cast<double>(t.billionths - first.billionths);
}

const Unit& unit_of(const std::string& name, const std::vector<WrittenTime>& written, TimeUnit usual,
                    std::vector<std::string>* guesses) {
  const Unit& expected = usual == TimeUnit::kSeconds ? kUnits.front() : kUnits.back();
  const auto interval = usual_interval(written);
  if (!interval) return expected;
  const auto rate_hz = [&](const Unit& u) { return static_cast<double>(u.per_second) / *interval; };
  const auto possible = [&](const Unit& u) { return is_rate_of_camera(rate_hz(u)); };
  const double first_s = static_cast<double>(written.front().whole) / static_cast<double>(expected.per_second);
  const bool dated = first_s > kDates_s && first_s < kDatesEnd_s;  // which it would be in no other unit
  if (possible(expected) || (dated && rate_hz(expected) < kSlowest_hz)) return expected;
  constexpr double kLikely_hz = 20;
  const auto unlikely = [&](const Unit& u) { return std::abs(std::log(rate_hz(u) / kLikely_hz)); };
  const Unit& best = *std::ranges::min_element(kUnits, {}, unlikely);
  const std::string in_expected = std::string("in ") + expected.name + " its images would come " +
                                  short_number(rate_hz(expected)) + " times a second";
  if (!possible(best)) {
    throw UserError(name + ": " + in_expected + ", and in no other unit as a camera's do (" +
                    short_number(kSlowest_hz) + " to " + short_number(kFastest_hz) + ")");
  }
  guesses->push_back(name + ": " + in_expected + "; its times are taken for " + best.name + ", which makes " +
                     short_number(rate_hz(best)) + " images a second");
  return best;
}

// Seconds from each image that has a time to the next.
std::vector<double> intervals_s(const std::vector<std::optional<TimeNs>>& source_ns) {
  std::vector<double> intervals;
  std::optional<TimeNs> last_ns;
  for (const auto& t_ns : source_ns) {
    if (t_ns && last_ns) intervals.push_back(to_seconds(*t_ns) - to_seconds(*last_ns));
    if (t_ns) last_ns = t_ns;
  }
  return intervals;
}

// Median over stretches of a few intervals of their mean: that of images in bursts, too; pauses do not count.
std::optional<double> median_of_means(const std::vector<double>& intervals) {
  if (intervals.empty()) return std::nullopt;
  const std::size_t few = std::clamp<std::size_t>(intervals.size() / 2, 1, 8);
  std::vector<double> means;
  for (std::size_t i = 0; i + few <= intervals.size(); ++i) {
    const auto first = intervals.begin() + static_cast<std::ptrdiff_t>(i);
    means.push_back(std::accumulate(first, first + static_cast<std::ptrdiff_t>(few), 0.0) / static_cast<double>(few));
  }
  const auto middle = means.begin() + static_cast<std::ptrdiff_t>(means.size() / 2);
  std::ranges::nth_element(means, middle);
  return *middle;
}

std::ptrdiff_t shorter_than(double most, const std::vector<double>& intervals) {
  return std::ranges::count_if(intervals, [&](double interval) { return interval < most; });
}

// Seconds an image of the straight line through the times at which images came.
double even_interval_s(const std::vector<double>& intervals) {
  const double middle = 0.5 * static_cast<double>(intervals.size());
  double t_s = 0, sum_of_products = 0, sum_of_squares = middle * middle;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    t_s += intervals[i];
    const double from_middle = static_cast<double>(i + 1) - middle;
    sum_of_products += from_middle * t_s;
    sum_of_squares += from_middle * from_middle;
  }
  return sum_of_products / sum_of_squares;
}

// Where something held images of an even rate back and brought most of them right after another, these are spread from
// the first on; false: the times may be true.
bool spread_bursts(std::vector<std::optional<TimeNs>>* source_ns) {
  constexpr double kLongest_s = 1, kShort = 0.125;
  const auto intervals = intervals_s(*source_ns);
  const double interval_s = even_interval_s(intervals), longest_s = std::ranges::max(intervals);
  const bool most = 5 * shorter_than(kShort * interval_s, intervals) > 3 * std::ssize(intervals);  // not of pairs
  if (!most || longest_s > kLongest_s) return false;
  double late_s = 0, least_late_s = 0, most_late_s = 0;
  for (const double interval : intervals) {
    late_s += interval - interval_s;
    least_late_s = std::min(least_late_s, late_s);
    most_late_s = std::max(most_late_s, late_s);
  }
  if (most_late_s - least_late_s > longest_s) return false;
  std::optional<TimeNs> first_ns;
  double since_first_s = 0;
  for (auto& t_ns : *source_ns) {
    if (!t_ns) continue;
    if (!first_ns) first_ns = t_ns;
    t_ns = *first_ns + to_ns(since_first_s);
    since_first_s += interval_s;
  }
  return true;
}

// Source times as they were written, without those that repeat the one before.
void count_from(const std::string& name, const std::vector<WrittenTime>& written, const WrittenTime& zero,
                std::int64_t ns_per_unit, SourceTimes* out) {
  std::size_t repeated = 0;
  for (std::size_t i = 0; i < written.size(); ++i) {
    const WrittenTime& t = written[i];
    if (i > 0 && t == written[i - 1]) {
      ++repeated;
      out->source_ns.emplace_back();
      continue;
    }
    const std::int64_t units = t.whole - zero.whole, billionths = t.billionths - zero.billionths;
    if (std::abs(static_cast<double>(units)) * static_cast<double>(ns_per_unit) > 9e18) {
      throw UserError(name + ": its times span more than 290 years");
    }
    out->source_ns.emplace_back(units * ns_per_unit + billionths * ns_per_unit / kBillion);
  }
  if (2 * repeated > written.size()) {
    throw UserError(name + ": its times are too coarse: " + std::to_string(repeated) + " of " +
                    std::to_string(written.size()) + " images have the time of the one before");
  }
  if (repeated > 0) {
    out->guesses.push_back(name + ": " + std::to_string(repeated) + (repeated == 1 ? " image has" : " images have") +
                           " the time of the one before; left out");
  }
}

// A sentence about the longest time without an image, where it is far longer than usual; else empty.
std::string said_of_gap(const std::string& name, const std::vector<std::optional<TimeNs>>& source_ns) {
  constexpr double kMinute_s = 60, kTimes = 100;
  const auto intervals = intervals_s(source_ns);
  const auto usual_s = median_of_means(intervals);
  if (!usual_s) return {};
  const auto longest = std::ranges::max_element(intervals);
  if (*longest < std::max(kMinute_s, kTimes * *usual_s)) return {};
  return name + ": after its first " + std::to_string(longest - intervals.begin() + 1) + " images none comes for " +
         short_number(*longest) + " s: a pause, or a clock that was set; played so";
}

}  // namespace

std::optional<double> usual_interval(const std::vector<WrittenTime>& written) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < written.size(); ++i) {
    if (written[i] != written[i - 1]) intervals.push_back(units_since(written[i], written[i - 1]));
  }
  return median_of_means(intervals);
}

std::string said_of_bursts(const std::string& name, const std::vector<std::optional<TimeNs>>& source_ns) {
  constexpr std::size_t kEnough = 16;
  constexpr double kShort = 0.25;
  const auto intervals = intervals_s(source_ns);
  const auto interval_s = median_of_means(intervals);
  if (intervals.size() < kEnough) return {};
  const auto in_bursts = shorter_than(kShort * *interval_s, intervals);
  if (4 * in_bursts < std::ssize(intervals)) return {};
  return name + ": its images come in bursts: " + std::to_string(in_bursts) + " of " +
         std::to_string(intervals.size() + 1) + " within " + short_number(1e3 * kShort * *interval_s) +
         " ms of the one before, where " + short_number(1 / *interval_s) + " a second come on average";
}

bool is_rate_of_camera(double rate_hz) { return rate_hz >= kSlowest_hz && rate_hz <= kFastest_hz; }

std::optional<WrittenTime> parse_written_time(std::string_view text) {
  const bool negative = text.starts_with('-');
  const std::string_view number = text.substr(negative ? 1 : 0);
  const std::size_t point = std::min(number.find('.'), number.size());
  const auto whole = digits(number.substr(0, point));
  const auto part = billionths_of(point < number.size() ? number.substr(point + 1) : std::string_view());
  if (whole && part) return negative ? normalised(-*whole, -*part) : normalised(*whole, *part);
  if (const auto date = parse_date(text)) return date;
  const auto value = parse_double(text);  // with an exponent
  constexpr double kMost = 4e18;
  if (!value || std::abs(*value) > kMost) return std::nullopt;
  const double floor = std::floor(*value);
  return normalised(static_cast<std::int64_t>(floor), std::llround(1e9 * (*value - floor)));
}

SourceTimes source_times(const std::string& name, const std::vector<WrittenTime>& written, TimeUnit usual) {
  constexpr double kHour_s = 3600;
  SourceTimes out;
  if (written.empty()) return out;
  const Unit& unit = unit_of(name, written, usual, &out.guesses);
  const std::int64_t ns_per_unit = kBillion / unit.per_second;
  const double first_s = units_since(written.front(), {}) / static_cast<double>(unit.per_second);
  const bool from_first = usual == TimeUnit::kNanoseconds || first_s > kHour_s;
  if (from_first && first_s > kHour_s && first_s < kDates_s && usual == TimeUnit::kSeconds) {
    out.guesses.push_back(name + ": its first image is at " + short_number(first_s) + " s; times count from there");
  }
  const WrittenTime zero = from_first ? written.front() : WrittenTime();
  if (std::abs(first_s) < 9e9) out.zero_ns = zero.whole * ns_per_unit + zero.billionths * ns_per_unit / kBillion;
  count_from(name, written, zero, ns_per_unit, &out);
  if (const std::string bursts = said_of_bursts(name, out.source_ns); !bursts.empty()) {
    out.guesses.push_back(bursts + (spread_bursts(&out.source_ns)
                                        ? "; they are spread evenly from the first on"
                                        : "; played so, though they may be times of arrival"));
  }
  if (const std::string gap = said_of_gap(name, out.source_ns); !gap.empty()) out.guesses.push_back(gap);
  const auto early = std::ranges::count_if(out.source_ns, [](const auto& t) { return t && *t < 0; });
  if (early > 0) {
    out.guesses.push_back(name + ": of its images " + std::to_string(early) +
                          " are before time 0, where play begins; left out");
  }
  return out;
}

}  // namespace coslam
