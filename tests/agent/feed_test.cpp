// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/feed.h"

#include <gmock/gmock.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>
#include <vector>

#include "tests/support/eventually.h"

namespace coslam::feed_test {
namespace {

using ::testing::ElementsAre;

constexpr TimeNs kPeriodNs = 33'333'333;

// What a source was asked for, seen from the test's thread. Thread-safe.
class Log {
 public:
  void given(std::uint32_t images) { set(&Log::given_, images); }
  void ended() { set(&Log::ended_, true); }
  void stopped() { set(&Log::stopped_, true); }
  std::uint32_t given() const {
    const std::lock_guard lock(mutex_);
    return given_;
  }
  // True when it happened before the deadline.
  bool wait_given(std::uint32_t images) {
    return wait([&] { return given_ >= images; });
  }
  bool wait_ended() {
    return wait([&] { return ended_; });
  }
  bool wait_stopped() {
    return wait([&] { return stopped_; });
  }

 private:
  template <class Condition>
  bool wait(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, test::kDeadline, condition);
  }
  template <class Field, class Value>
  void set(Field field, Value value) {
    {
      const std::lock_guard lock(mutex_);
      this->*field = value;
    }
    changed_.notify_all();
  }
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::uint32_t given_ = 0;
  bool ended_ = false, stopped_ = false;
};

enum class Kind { kFile, kLive, kStuckCamera, kDyingCamera };

// Images 0, 1, 2 ...; a stuck camera gives none until it is stopped, a dying one no more.
class FakeSource final : public ImageSource {
 public:
  FakeSource(Log& log, std::uint32_t images, Kind kind = Kind::kFile) : log_(log), images_(images), kind_(kind) {}
  std::optional<Image> next() override {
    if (kind_ == Kind::kStuckCamera || (kind_ == Kind::kDyingCamera && next_ == images_)) log_.wait_stopped();
    if (kind_ == Kind::kStuckCamera || next_ == images_) {
      log_.ended();
      return std::nullopt;
    }
    const std::uint32_t i = next_++;
    log_.given(next_);
    return Image{FrameId(i), kPeriodNs * i, cv::Mat(48, 64, CV_8UC1, cv::Scalar(i / 2))};
  }
  bool skip() override {
    if (next_ == images_) return false;
    ++next_;
    return true;
  }
  std::optional<TimeNs> peek_ns() const override {
    return kind_ != Kind::kFile || next_ == images_ ? std::nullopt : std::optional(kPeriodNs * next_);
  }
  bool live() const override { return kind_ != Kind::kFile; }
  void stop() override { log_.stopped(); }

 private:
  Log& log_;
  std::uint32_t images_, next_ = 0;
  Kind kind_;
};

class FeedTest : public testing::Test {
 protected:
  std::unique_ptr<ImageSource> source(std::uint32_t images, Kind kind = Kind::kFile) {
    return std::make_unique<FakeSource>(log_, images, kind);
  }
  // Numbers of the images to the end.
  std::vector<std::uint32_t> drain(Feed& feed) const {
    std::vector<std::uint32_t> frames;
    while (const auto image = feed.next(stop_)) frames.push_back(image->frame.value);
    return frames;
  }
  static TimeNs now_utc_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
  }
  static constexpr TimeNs kHourNs = 3'600'000'000'000;
  Log log_;
  std::atomic<bool> stop_{false};
};

std::vector<std::uint32_t> numbers(std::uint32_t from, std::uint32_t to) {
  std::vector<std::uint32_t> out;
  out.reserve(to - from);
  for (std::uint32_t i = from; i < to; ++i) out.push_back(i);
  return out;
}

TEST_F(FeedTest, DirectReadsNothingAhead) {
  const auto feed = direct_feed(source(3));
  EXPECT_EQ(log_.given(), 0U);
  EXPECT_EQ(feed->next(stop_)->frame, FrameId(0));
  EXPECT_EQ(log_.given(), 1U);
  EXPECT_THAT(drain(*feed), ElementsAre(1, 2));
  EXPECT_FALSE(feed->next(stop_)) << "the end stays the end";
  EXPECT_EQ(feed->dropped(), 0U);
}

TEST_F(FeedTest, PrefetchingLosesNothingAndReadsALittleAhead) {
  const auto feed = prefetching_feed(source(50));
  for (std::uint32_t taken = 1; taken <= 50; ++taken) {
    ASSERT_TRUE(log_.wait_given(std::min(50U, taken + 2))) << "it reads while the taker is busy";
    EXPECT_LE(log_.given(), taken + 3) << "three wait, one more is in hand";
    EXPECT_EQ(feed->next(stop_)->frame, FrameId(taken - 1));
  }
  EXPECT_FALSE(feed->next(stop_));
  EXPECT_EQ(feed->dropped(), 0U);
}

TEST_F(FeedTest, ALiveSourceDropsTheOldestAndCounts) {
  const auto feed = real_time_feed(source(20, Kind::kLive), 1, 0);
  ASSERT_TRUE(log_.wait_ended());
  EXPECT_EQ(drain(*feed), numbers(12, 20)) << "a quarter of a second is kept";
  EXPECT_EQ(feed->dropped(), 12U);
}

TEST_F(FeedTest, ImagesThatAreLateFromTheStartAreDropped) {
  const auto feed = real_time_feed(source(20), 1, now_utc_ns() - kHourNs);
  EXPECT_TRUE(drain(*feed).empty());
  EXPECT_EQ(feed->dropped(), 20U);
}

TEST_F(FeedTest, RealTimeHandsNothingOutBeforeItIsDue) {
  const TimeNs start_ns = now_utc_ns() + 20'000'000;
  const auto feed = real_time_feed(source(4), 2, start_ns);
  std::uint32_t taken = 0;
  while (const auto image = feed->next(stop_)) {
    EXPECT_GE(now_utc_ns(), start_ns + image->capture_ns / 2) << "twice as fast";
    ++taken;
  }
  EXPECT_EQ(taken + feed->dropped(), 4U) << "a machine that is too busy drops some";
}

TEST_F(FeedTest, RealTimeThatHasNotBegunEndsAtOnce) {
  const auto begun = std::chrono::steady_clock::now();
  {
    const auto feed = real_time_feed(source(4), 1, now_utc_ns() + kHourNs);
    stop_ = true;
    EXPECT_FALSE(feed->next(stop_));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begun, test::kDeadline);
  EXPECT_EQ(log_.given(), 0U);
}

TEST_F(FeedTest, AStuckCameraDoesNotKeepTheFeedFromEnding) {
  { const auto feed = real_time_feed(source(4, Kind::kStuckCamera), 1, 0); }
  EXPECT_TRUE(log_.wait_stopped());
}

TEST_F(FeedTest, WhatIsWrongWithAnImageIsFoundInEachKindOfFeed) {
  const auto direct = direct_feed(source(4)), ahead = prefetching_feed(source(4));
  for (Feed* feed : {direct.get(), ahead.get()}) {
    EXPECT_EQ(feed->next(stop_)->fault, ImageFault::kFeatureless);
    EXPECT_EQ(feed->next(stop_)->fault, ImageFault::kFeatureless);
  }
}

TEST_F(FeedTest, ThatALiveCameraGivesNoImageAnyMoreIsTold) {
  const auto feed = real_time_feed(source(3, Kind::kDyingCamera), 1, 0);
  for (std::uint32_t i = 0; i < 3; ++i) EXPECT_EQ(feed->next(stop_)->frame, FrameId(i));
  for (int i = 0; i < 2; ++i) {
    const auto none = feed->next(stop_);
    ASSERT_TRUE(none);
    EXPECT_EQ(none->fault, ImageFault::kMissing);
    EXPECT_TRUE(none->grey.empty());
  }
}

TEST_F(FeedTest, AnUntakenFeedEnds) {
  { const auto feed = prefetching_feed(source(50)); }
  EXPECT_LE(log_.given(), 4U) << "it does not read on";
}

}  // namespace
}  // namespace coslam::feed_test
