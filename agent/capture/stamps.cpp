// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/stamps.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "common/base/error.h"
#include "common/base/text.h"

namespace coslam {
namespace {

constexpr std::int64_t kBillion = 1'000'000'000;
constexpr double kSlowest_hz = 0.2, kFastest_hz = 1000;
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

// Median of those between times that differ; empty where there is no such.
std::optional<double> usual_interval(const std::vector<WrittenTime>& written) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < written.size(); ++i) {
    if (written[i] != written[i - 1]) intervals.push_back(units_since(written[i], written[i - 1]));
  }
  if (intervals.empty()) return std::nullopt;
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

const Unit& unit_of(const std::string& name, const std::vector<WrittenTime>& written, TimeUnit usual,
                    std::vector<std::string>* guesses) {
  const Unit& expected = usual == TimeUnit::kSeconds ? kUnits.front() : kUnits.back();
  const auto interval = usual_interval(written);
  if (!interval) return expected;
  const auto rate_hz = [&](const Unit& u) { return static_cast<double>(u.per_second) / *interval; };
  const auto possible = [&](const Unit& u) { return rate_hz(u) >= kSlowest_hz && rate_hz(u) <= kFastest_hz; };
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

}  // namespace

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
  std::size_t repeated = 0;
  for (std::size_t i = 0; i < written.size(); ++i) {
    const WrittenTime& t = written[i];
    if (i > 0 && t == written[i - 1]) {
      ++repeated;
      out.source_ns.emplace_back();
      continue;
    }
    const std::int64_t units = t.whole - zero.whole, billionths = t.billionths - zero.billionths;
    if (std::abs(static_cast<double>(units)) * static_cast<double>(ns_per_unit) > 9e18) {
      throw UserError(name + ": its times span more than 290 years");
    }
    out.source_ns.emplace_back(units * ns_per_unit + billionths * ns_per_unit / kBillion);
  }
  const auto early = std::ranges::count_if(out.source_ns, [](const auto& t) { return t && *t < 0; });
  if (early > 0) {
    out.guesses.push_back(name + ": of its images " + std::to_string(early) +
                          " are before time 0, where play begins; left out");
  }
  if (repeated > 0) {
    out.guesses.push_back(name + ": " + std::to_string(repeated) + (repeated == 1 ? " image has" : " images have") +
                          " the time of the one before; left out");
  }
  return out;
}

}  // namespace coslam
