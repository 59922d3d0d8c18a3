// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/recorded_clock.h"

#include <gmock/gmock.h>

namespace coslam::recorded_clock_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr TimeNs kStart_ns = 1'700'000'000'000'000'000, kPeriod_ns = 50'000'000, kDelay_ns = 2'000'000;

// Thirty images, received a little after they were taken; `stamp` changes the stamp of each.
template <class Stamp>
RecordedClock clock_of(const Stamp& stamp) {
  std::vector<RecordedTime> first;
  for (int i = 0; i < 30; ++i) {
    const TimeNs taken_ns = kStart_ns + i * kPeriod_ns;
    first.push_back({stamp(i, taken_ns), taken_ns + kDelay_ns});
  }
  return recorded_clock("a.bag", first, kStart_ns);
}

void expect_by_receipt(const RecordedClock& clock, const char* why) {
  EXPECT_FALSE(clock.by_stamps);
  EXPECT_EQ(clock.source_ns({1, kStart_ns}), 100'000'000) << "a little after the recording began";
  EXPECT_THAT(clock.guesses,
              ElementsAre("a.bag: " + std::string(why) + "; the times at which they were received count"));
}

TEST(RecordedClocks, StampsCountFromTheBeginningOfTheRecording) {
  const RecordedClock clock = clock_of([](int, TimeNs taken_ns) { return taken_ns; });
  EXPECT_TRUE(clock.by_stamps);
  EXPECT_EQ(clock.source_ns({kStart_ns, 0}), 100'000'000);
  EXPECT_THAT(clock.guesses, IsEmpty());
}

TEST(RecordedClocks, StampsOfAnotherClockCountFromTheEarliest) {
  const RecordedClock clock = clock_of([](int i, TimeNs) { return (1 + (i ^ 1)) * kPeriod_ns; });
  EXPECT_EQ(clock.source_ns({kPeriod_ns, 0}), 0) << "which came second";
  EXPECT_THAT(clock.guesses, IsEmpty());
}

TEST(RecordedClocks, AFirstImageWithoutAStampIsPassedOver) {
  const RecordedClock clock = clock_of([](int i, TimeNs taken_ns) { return i == 0 ? 0 : taken_ns; });
  EXPECT_TRUE(clock.by_stamps);
  EXPECT_THAT(clock.guesses, IsEmpty());
}

TEST(RecordedClocks, StampsThatTellNothingGiveWay) {
  expect_by_receipt(clock_of([](int, TimeNs) { return 0; }), "most of its images have no stamp");
  expect_by_receipt(clock_of([](int, TimeNs) { return kStart_ns; }), "most of its images have the stamp of another");
  expect_by_receipt(clock_of([](int i, TimeNs) { return kStart_ns + i * kPeriod_ns / 1000; }),
                    "by their stamps its images would come 20000 times a second, and were received 20 times a second");
}

TEST(RecordedClocks, StampsThatNothingContradictStay) {
  const std::vector<RecordedTime> at_once(5, {kStart_ns, kStart_ns});
  EXPECT_TRUE(recorded_clock("a.bag", at_once, kStart_ns).by_stamps);
  const std::vector<RecordedTime> seldom = {{kStart_ns, kStart_ns}, {kStart_ns + to_ns(60), kStart_ns + to_ns(60)}};
  EXPECT_TRUE(recorded_clock("a.bag", seldom, kStart_ns).by_stamps);
  EXPECT_TRUE(recorded_clock("a.bag", {}, kStart_ns).by_stamps);
}

TEST(RecordedClocks, BurstsAreSaid) {
  const RecordedClock clock = clock_of([](int i, TimeNs) { return kStart_ns + (i / 3 * 75 + i % 3) * 2'000'000; });
  EXPECT_TRUE(clock.by_stamps);
  EXPECT_THAT(clock.guesses, ElementsAre(HasSubstr("a.bag: its images come in bursts: 20 of 30 within ")));
}

}  // namespace
}  // namespace coslam::recorded_clock_test
