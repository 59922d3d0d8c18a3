// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/base/text.h"

#include <gtest/gtest.h>

namespace coslam::text_test {
namespace {

TEST(Text, SecondsKeepNanoseconds) {
  EXPECT_EQ(parse_seconds("0.05"), 50'000'000);
  EXPECT_EQ(parse_seconds("1403638518.377829376"), 1403638518377829376);
  EXPECT_EQ(parse_seconds("-0.000000001"), -1);
  EXPECT_EQ(parse_seconds("2"), 2'000'000'000);
  EXPECT_EQ(parse_seconds("1.5e1"), 15'000'000'000);
  EXPECT_EQ(parse_seconds("0.0000000019"), 2);
  EXPECT_EQ(parse_seconds("3."), 3'000'000'000);
  for (const char* bad : {"", "-", ".", "1.2.3", "1 2", "nan", "inf", "1e300", "9999999999", "0x10"}) {
    EXPECT_EQ(parse_seconds(bad), std::nullopt) << bad;
  }
}

TEST(Text, DatesAndNumbersOfRuns) {
  constexpr TimeNs kUtc_ns = 1'700'000'000'999'999'999;
  EXPECT_EQ(format_utc(kUtc_ns, "%Y-%m-%d %H:%M:%S UTC"), "2023-11-14 22:13:20 UTC");
  EXPECT_EQ(format_hex(0x1f), "000000000000001f");
  EXPECT_EQ(format_hex(~std::uint64_t{0}), "ffffffffffffffff");
}

TEST(Text, FormatsWhatItParses) {
  for (const TimeNs t : {TimeNs{0}, TimeNs{1}, TimeNs{-1}, TimeNs{1403638518377829376}, TimeNs{-2'500'000'000}}) {
    EXPECT_EQ(parse_seconds(format_seconds(t)), t) << format_seconds(t);
  }
  EXPECT_EQ(format_seconds(50'000'000), "0.050000000");
  for (const double v : {0.0, 0.1, 29.97, 0.4000001, 1.0 / 3, -2.5e-300, 1.7976931348623157e308}) {
    EXPECT_EQ(parse_double(format_double(v)), v) << format_double(v);
  }
  EXPECT_EQ(format_double(0.1), "0.1");
}

TEST(Text, Splits) {
  EXPECT_EQ(split_fields(" a  b\tc\r"), (std::vector<std::string_view>{"a", "b", "c"}));
  EXPECT_TRUE(split_fields("  ").empty());
  EXPECT_EQ(split_csv("a, b ,,c\r"), (std::vector<std::string_view>{"a", "b", "", "c"}));
  EXPECT_EQ(split_csv(""), (std::vector<std::string_view>{""}));
  EXPECT_EQ(trimmed(" \t x y \n"), "x y");
}

TEST(Text, NumbersAreWholeOrNothing) {
  EXPECT_EQ(parse_double("-1.5e-3"), -1.5e-3);
  EXPECT_EQ(parse_double("1.5px"), std::nullopt);
  EXPECT_EQ(parse_double("nan"), std::nullopt);
  EXPECT_EQ(parse_integer("42"), 42);
  EXPECT_EQ(parse_integer("4.2"), std::nullopt);
  EXPECT_EQ(parse_integer("99999999999999999999"), std::nullopt);
}

TEST(Text, FindsTheNearestWord) {
  const std::vector<std::string> known = {"max_tracks", "window_px", "rate_hz"};
  EXPECT_EQ(nearest_of("max_track", known), "max_tracks");
  EXPECT_EQ(nearest_of("maxtracks", known), "max_tracks");
  EXPECT_EQ(nearest_of("rate", known), "rate_hz");
  EXPECT_EQ(nearest_of("tracks", known), "max_tracks");
  EXPECT_EQ(nearest_of("rats", known), "");
  EXPECT_EQ(nearest_of("colour", known), "");
}

}  // namespace
}  // namespace coslam::text_test
