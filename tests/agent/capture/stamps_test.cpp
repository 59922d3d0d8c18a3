// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/stamps.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::stamps_test {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Optional;

TEST(WrittenTimes, AreReadToTheLastDigit) {
  EXPECT_THAT(parse_written_time("1305031102.175304"), Optional(WrittenTime{1305031102, 175304000}));
  EXPECT_THAT(parse_written_time("1403636579763555584"), Optional(WrittenTime{1403636579763555584, 0}));
  EXPECT_THAT(parse_written_time("-0.2"), Optional(WrittenTime{-1, 800'000'000}));
  EXPECT_THAT(parse_written_time("7."), Optional(WrittenTime{7, 0}));
  EXPECT_THAT(parse_written_time("0.99999999951"), Optional(WrittenTime{1, 0}));
  EXPECT_THAT(parse_written_time("1.037e-01"), Optional(WrittenTime{0, 103'700'000}));
  EXPECT_THAT(parse_written_time("1.036000000000000032e-01"), Optional(WrittenTime{0, 103'600'000}));
  const auto double_precision = parse_written_time("1.305031102175304000e+09");
  ASSERT_TRUE(double_precision);
  EXPECT_EQ(double_precision->whole, 1305031102);
  EXPECT_NEAR(static_cast<double>(double_precision->billionths), 175304000, 200);
  EXPECT_THAT(parse_written_time("2011-09-26 13:02:25.964389445"), Optional(WrittenTime{1317042145, 964389445}));
  EXPECT_THAT(parse_written_time("2011-09-26T13:02:25Z"), Optional(WrittenTime{1317042145, 0}));
  for (const char* bad :
       {"", "-", ".5.", "1,5", "12:30", "2011-13-26 13:02:25", "2011-02-30 13:02:25", "2011-09-26 25:02:25", "nan",
        "1e300", "99999999999999999999", "9000000000000000000", "0.1s", "0.1234567890abc"}) {
    EXPECT_EQ(parse_written_time(bad), std::nullopt) << bad;
  }
}

// Of these, written as text.
SourceTimes meant(const std::vector<std::string>& texts, TimeUnit usual = TimeUnit::kSeconds) {
  std::vector<WrittenTime> written;
  for (const std::string& text : texts) written.push_back(parse_written_time(text).value());
  return source_times("times.txt", written, usual);
}

TEST(SourceTimes, InTheUsualUnitNothingIsGuessed) {
  const SourceTimes m = meant({"0.5", "0.54", "0.58"});
  EXPECT_THAT(m.source_ns, ElementsAre(500'000'000, 540'000'000, 580'000'000));
  EXPECT_TRUE(m.guesses.empty());
  EXPECT_TRUE(meant({"1403636579763555584", "1403636579813555584"}, TimeUnit::kNanoseconds).guesses.empty());
}

TEST(SourceTimes, DatesCountFromTheFirst) {
  for (const SourceTimes& m : {meant({"1305031102.175304", "1305031102.211214"}),
                               meant({"2011-09-26 13:02:25.964389", "2011-09-26 13:02:26.000299"})}) {
    EXPECT_THAT(m.source_ns, ElementsAre(0, 35'910'000));
    EXPECT_GT(m.zero_ns, 1'300'000'000'000'000'000);
    EXPECT_TRUE(m.guesses.empty());
  }
}

TEST(SourceTimes, TheRateTellsTheUnit) {
  struct Case {
    std::vector<std::string> texts;
    TimeUnit usual;
    const char* unit;
  };
  for (const Case& c : {
           Case{{"0", "33.333", "66.667", "100"}, TimeUnit::kSeconds, "milliseconds"},
           Case{{"0", "33333", "66667", "100000"}, TimeUnit::kSeconds, "microseconds"},
           Case{{"1403636579763555584", "1403636579796888584", "1403636579830222584", "1403636579863555584"},
                TimeUnit::kSeconds,
                "nanoseconds"},
           Case{{"1700000000000", "1700000000033", "1700000000067", "1700000000100"},
                TimeUnit::kNanoseconds,
                "milliseconds"},
           Case{{"1700000000000000", "1700000000033333", "1700000000066667", "1700000000100000"},
                TimeUnit::kNanoseconds,
                "microseconds"},
       }) {
    const SourceTimes m = meant(c.texts, c.usual);
    ASSERT_EQ(m.source_ns.size(), 4U);
    EXPECT_EQ(m.source_ns.front(), 0);
    EXPECT_NEAR(static_cast<double>(*m.source_ns.back()), 1e8, 1e6) << c.unit;
    ASSERT_EQ(m.guesses.size(), 1U);
    EXPECT_THAT(m.guesses.front(), HasSubstr(std::string("taken for ") + c.unit));
    EXPECT_THAT(m.guesses.front(), HasSubstr("times.txt: "));
  }
}

TEST(SourceTimes, OneThatIsInNoUnitACamerasIsRefused) {
  const std::string error = test::error_of<UserError>([] { meant({"0", "2e10", "4e10"}); });
  EXPECT_THAT(error,
              HasSubstr("times.txt: in seconds its images would come 5e-11 times a second, and in no other unit"));
  EXPECT_EQ(meant({"5"}).source_ns.size(), 1U) << "one has no rate";
}

TEST(SourceTimes, AClockThatCountsSinceTheMachineWasStartedCountsFromTheFirst) {
  const SourceTimes m = meant({"123456.7", "123456.8", "123456.9"});
  EXPECT_THAT(m.source_ns, ElementsAre(0, 100'000'000, 200'000'000));
  EXPECT_THAT(m.guesses, ElementsAre(HasSubstr("its first image is at 1.235e+05 s; times count from there")));
  EXPECT_THAT(meant({"60", "60.1"}).source_ns, ElementsAre(60'000'000'000, 60'100'000'000)) << "a later start";
}

TEST(SourceTimes, ImagesBeforeZeroAreSaid) {
  const SourceTimes m = meant({"-0.2", "-0.1", "0", "0.1"});
  EXPECT_THAT(m.source_ns, ElementsAre(-200'000'000, -100'000'000, 0, 100'000'000));
  EXPECT_THAT(m.guesses, ElementsAre(HasSubstr("of its images 2 are before time 0, where play begins; left out")));
}

TEST(SourceTimes, AClockThatWasSetIsSaid) {
  const auto set_by = [](int later_s) {
    std::vector<std::string> times;
    for (int i = 0; i < 40; ++i)
      times.push_back(std::to_string(i / 10 + (i < 20 ? 0 : later_s)) + "." + std::to_string(i % 10));
    return meant(times);
  };
  EXPECT_EQ(set_by(3600).source_ns.back(), 3'603'900'000'000);
  EXPECT_THAT(
      set_by(3600).guesses,
      ElementsAre("times.txt: after its first 20 images none comes for 3600 s: a pause, or a clock that was set; "
                  "played so"));
  EXPECT_THAT(set_by(30).guesses, IsEmpty());
}

TEST(SourceTimes, DatesMayBeFarApart) {
  const SourceTimes m = meant({"1305031102.1", "1305031112.1", "1305031122.1"});
  EXPECT_THAT(m.source_ns, ElementsAre(0, 10'000'000'000, 20'000'000'000));
  EXPECT_TRUE(m.guesses.empty());
}

TEST(SourceTimes, ARepeatedTimeCostsAnImage) {
  const SourceTimes m = meant({"0", "0.1", "0.1", "0.2"});
  EXPECT_THAT(m.source_ns, ElementsAre(0, 100'000'000, std::nullopt, 200'000'000));
  EXPECT_THAT(m.guesses, ElementsAre(HasSubstr("1 image has the time of the one before; left out")));
}

TEST(SourceTimes, ThatAreMostlyTheSameAreRefused) {
  EXPECT_EQ(test::error_of<UserError>([] {
              meant({"1.4e9", "1.4e9", "1.4e9", "1.4e9"});
            }),
            "times.txt: its times are too coarse: 3 of 4 images have the time of the one before");
}

// Images in bursts of so many, the bursts at the given interval.
std::vector<std::string> bursts(int images, int of, double interval_ms, double within_ms) {
  std::vector<std::string> texts;
  for (int i = 0; i < images; ++i) texts.push_back(std::to_string(1e-3 * (i / of * interval_ms + i % of * within_ms)));
  return texts;
}

TEST(SourceTimes, ImagesThatCameInBurstsAreSpread) {
  for (const auto& texts : {bursts(80, 4, 200, 2), bursts(80, 4, 200, 0.5), bursts(100, 5, 250, 3)}) {
    const SourceTimes m = meant(texts);
    for (std::size_t i = 0; i < texts.size(); ++i) {
      EXPECT_NEAR(to_seconds(*m.source_ns[i]), 0.05 * static_cast<double>(i), 0.015) << i;
    }
    ASSERT_EQ(m.guesses.size(), 1U);
    EXPECT_THAT(m.guesses.front(), EndsWith("a second come on average; they are spread evenly from the first on"));
  }
  EXPECT_THAT(
      meant(bursts(80, 4, 200, 2)).guesses.front(),
      HasSubstr("times.txt: its images come in bursts: 60 of 80 within 12.5 ms of the one before, where 20 a "));
}

TEST(SourceTimes, BurstsThatMayBeTrueAreSaidAlone) {
  std::vector<std::string> with_pause = bursts(40, 4, 200, 2);
  for (const std::string& text : bursts(40, 4, 200, 2)) with_pause.push_back(std::to_string(60 + std::stod(text)));
  for (const auto& texts : {bursts(80, 2, 100, 5), bursts(81, 3, 100, 5), with_pause}) {
    const SourceTimes m = meant(texts);
    EXPECT_EQ(*m.source_ns[1], meant({texts[0], texts[1]}).source_ns[1]) << "as it is written";
    ASSERT_EQ(m.guesses.size(), 1U);
    EXPECT_THAT(m.guesses.front(), EndsWith("; played so, though they may be times of arrival"));
  }
}

TEST(SourceTimes, AnUnevenRateIsNoBursts) {
  std::vector<std::string> texts;
  for (int i = 0; i < 60; ++i) {
    if (i % 7 != 3) texts.push_back(std::to_string(0.05 * i + (i % 3) * 0.015 + (i > 30 ? 20 : 0)));
  }
  EXPECT_TRUE(meant(texts).guesses.empty());
}

TEST(SourceTimes, SpansThatNoClockHasAreRefused) {
  EXPECT_THAT(test::error_of<UserError>([] { meant({"0", "1", "2", "3", "3e18"}); }), HasSubstr("290 years"));
}

}  // namespace
}  // namespace coslam::stamps_test
