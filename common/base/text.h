// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/time.h"

namespace coslam {

std::string_view trimmed(std::string_view text);
// Non-empty fields between any of the separator characters.
std::vector<std::string_view> split_fields(std::string_view line, std::string_view separators = " \t\r");
// Fields of a CSV line without quotes, empty ones kept, blanks around them removed.
std::vector<std::string_view> split_csv(std::string_view line);

// The whole text as one number; empty for anything else, infinities and NaN included.
std::optional<double> parse_double(std::string_view text);
// The shortest text that reads back as the same number.
std::string format_double(double value);
std::string format_tenths(double value);  // the same, rounded to one decimal
std::optional<std::int64_t> parse_integer(std::string_view text);

// Decimal seconds, kept exact to the nanosecond (a double would lose 100 ns on a UTC stamp).
std::optional<TimeNs> parse_seconds(std::string_view text);
std::string format_seconds(TimeNs t_ns);  // 9 decimals
// A date, by the fields of strftime.
std::string format_utc(TimeNs utc_ns, const char* fields);

std::string format_hex(std::uint64_t number);  // 16 digits

// The known word closest to `word` by edit distance, or one that it begins or ends; empty when none is near.
std::string nearest_of(std::string_view word, const std::vector<std::string>& known);

}  // namespace coslam
