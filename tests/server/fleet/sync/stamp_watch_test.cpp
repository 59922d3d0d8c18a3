// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/sync/stamp_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <random>

namespace coslam::stamp_watch_test {
namespace {

using testing::HasSubstr;

constexpr TimeNs kUtc_ns = 1'700'000'000'000'000'000;  // at the server's time 0

// Three cameras at 30 Hz that are right, but for what a test does to the first. Links take 2 to 12 ms.
class StampWatchTest : public testing::Test {
 protected:
  StampWatchTest() {
    for (std::uint16_t i = 0; i < 3; ++i) watch_.add(CameraId(i), "cam" + std::to_string(i), 30);
  }
  struct Outcome {
    int used = 0, refused = 0;
    double worst_s = 0;  // of what was used, against when it was taken
  };
  // Plays one time; stamp_s: how the first camera dates what it takes at a time; late_s: what its link takes longer,
  // and what those of the others do.
  std::map<int, Outcome> play(
      double from_s, double to_s, const std::function<double(double)>& stamp_s,
      const std::function<double(double)>& late_s = [](double) { return 0.0; },
      const std::function<double(double)>& others_late_s = [](double) { return 0.0; }) {
    std::uniform_real_distribution<> delay_s(0.002, 0.012);
    struct Frame {
      int camera = 0;
      TimeNs stamp_ns = 0;
      double taken_s = 0;
    };
    std::multimap<double, Frame> arrivals;
    for (double t_s = from_s; t_s < to_s; t_s += 1 / 30.0) {
      for (int c = 0; c < 3; ++c) {
        const double stamp = c == 0 ? stamp_s(t_s) : t_s;
        link_s_[c] = std::max(link_s_[c] + 1e-5,
                              t_s + delay_s(random_) + (c == 0 ? late_s(t_s) : others_late_s(t_s)));  // in order
        arrivals.emplace(link_s_[c], Frame{c, kUtc_ns + to_ns(stamp), t_s});
      }
    }
    std::map<int, Outcome> out;
    for (const auto& [at_s, frame] : arrivals) {
      const int c = frame.camera;
      const auto t_ns = watch_.place(CameraId(static_cast<std::uint16_t>(c)), frame.stamp_ns, to_ns(at_s));
      ++(t_ns ? out[c].used : out[c].refused);
      if (!t_ns) continue;
      EXPECT_GT(*t_ns, newest_[c]) << "time runs forward";
      newest_[c] = *t_ns;
      out[c].worst_s = std::max(out[c].worst_s, std::abs(to_seconds(*t_ns - kUtc_ns) - frame.taken_s));
    }
    return out;
  }
  static void expect_untouched(std::map<int, Outcome>& out) {
    for (const int c : {1, 2}) {
      EXPECT_EQ(out[c].refused, 0) << c;
      EXPECT_LT(out[c].worst_s, 1e-6) << c;
    }
  }
  std::string warnings() {
    std::string all;
    for (const std::string& w : watch_.take_warnings()) all += w + "\n";
    return all;
  }

  StampWatch watch_{{kUtc_ns}};
  std::mt19937 random_{1};
  std::map<int, double> link_s_;  // when the last frame arrived
  std::map<int, TimeNs> newest_;
};

TEST_F(StampWatchTest, GoodClocksAreUsedAsTheyAre) {
  auto out = play(0, 20, [](double t) { return t; });
  expect_untouched(out);
  EXPECT_EQ(out[0].refused, 0);
  EXPECT_LT(out[0].worst_s, 1e-6);
  EXPECT_EQ(warnings(), "");
}

TEST_F(StampWatchTest, AClockFarOffIsCorrectedAndSaid) {
  for (const double off_s : {5.0, -5.0, 3600.0, -3600.0}) {
    watch_ = StampWatch({kUtc_ns});
    for (std::uint16_t i = 0; i < 3; ++i) watch_.add(CameraId(i), "cam" + std::to_string(i), 30);
    newest_.clear();
    link_s_.clear();
    auto out = play(0, 10, [&](double t) { return t + off_s; });
    expect_untouched(out);
    EXPECT_GT(out[0].used, 200) << off_s;
    EXPECT_LT(out[0].worst_s, 0.05) << off_s;
    const std::string said = warnings();
    EXPECT_THAT(said, HasSubstr("the clock of agent cam0 is")) << off_s;
    EXPECT_THAT(said, HasSubstr(off_s > 0 ? "ahead of" : "behind")) << off_s;
    EXPECT_EQ(std::ranges::count(said, '\n'), 1) << said;
  }
}

TEST_F(StampWatchTest, AClockThatIsSetInTheRunIsCorrectedInThreeSeconds) {
  for (const double off_s : {5.0, -5.0}) {
    watch_ = StampWatch({kUtc_ns});
    for (std::uint16_t i = 0; i < 3; ++i) watch_.add(CameraId(i), "cam" + std::to_string(i), 30);
    newest_.clear();
    link_s_.clear();
    auto out = play(0, 30, [&](double t) { return t < 15 ? t : t + off_s; });
    expect_untouched(out);
    EXPECT_LT(out[0].refused, 90) << off_s;
    EXPECT_LT(out[0].worst_s, 0.05) << off_s;
  }
}

TEST_F(StampWatchTest, StampsThatRunTenTimesAsFastAreNotUsed) {
  auto out = play(0, 20, [](double t) { return 10 * t; });
  expect_untouched(out);
  EXPECT_LT(out[0].used, 30);
  EXPECT_THAT(warnings(), HasSubstr("do not run with time"));
}

TEST_F(StampWatchTest, AFrameOfAnotherCenturyIsLeftOut) {
  play(0, 5, [](double t) { return t; });
  EXPECT_FALSE(watch_.place(CameraId(0), 7'258'118'400'000'000'000, to_ns(5)));
  EXPECT_FALSE(watch_.place(CameraId(0), std::numeric_limits<TimeNs>::min() + 1, to_ns(5)));
  EXPECT_FALSE(watch_.place(CameraId(0), std::numeric_limits<TimeNs>::min(), to_ns(5)));
  EXPECT_FALSE(watch_.place(CameraId(0), 0, to_ns(5)));
  auto out = play(5.1, 10, [](double t) { return t; });
  expect_untouched(out);
  EXPECT_EQ(out[0].refused, 0);
}

// Its first frames come seconds late, and one later than the other.
TEST_F(StampWatchTest, ASlowLinkFromTheStartIsNoClock) {
  auto out = play(
      0, 20, [](double t) { return t; }, [](double t) { return 2.2 + 0.4 * std::sin(t); });
  expect_untouched(out);
  EXPECT_GT(out[0].used, 450);
  EXPECT_LT(out[0].worst_s, 1e-6);
}

// A link that stalls delivers all at once: that is no clock.
TEST_F(StampWatchTest, AStalledLinkIsNoClock) {
  auto out = play(
      0, 20, [](double t) { return t; }, [](double t) { return t > 8 && t < 10 ? 10 - t : 0.0; });
  expect_untouched(out);
  EXPECT_EQ(out[0].refused, 0);
  EXPECT_EQ(warnings(), "");
}

// The others' links are full for a while, and then the first one's too; each comes out of it in its own time.
TEST_F(StampWatchTest, LinksThatFillAndEmptyInTheirOwnTimesAreNoClocks) {
  const auto full = [](double t, double from, double to) {
    return std::clamp(std::min(t - from, 3 * (to - t)), 0.0, 1.2);
  };
  auto out = play(
      0, 40, [](double t) { return t; }, [&](double t) { return full(t, 5, 14) + full(t, 22, 30); },
      [&](double t) { return full(t, 3, 18) + full(t, 21, 34); });
  expect_untouched(out);
  EXPECT_EQ(out[0].refused, 0);
  EXPECT_LT(out[0].worst_s, 1e-6);
  EXPECT_EQ(warnings(), "");
}

TEST_F(StampWatchTest, AnAgentAloneIsDatedByTheServersClock) {
  StampWatch watch({kUtc_ns});
  watch.add(CameraId(0), "alone", 30);
  int used = 0;
  for (int i = 0; i < 150; ++i) {
    const double t_s = i / 30.0;
    const auto t_ns = watch.place(CameraId(0), to_ns(t_s + 77), to_ns(t_s + 0.01));  // since its camera was switched on
    if (!t_ns) continue;
    EXPECT_NEAR(to_seconds(*t_ns - kUtc_ns), t_s, 0.05);
    ++used;
  }
  EXPECT_GT(used, 80);
}

TEST_F(StampWatchTest, RecordingsAreDatedByPlayedTime) {
  StampWatch watch({kUtc_ns, -to_ns(100)});
  watch.add(CameraId(0), "a", 30);
  watch.add(CameraId(1), "b", 30);
  for (int i = 0; i < 60; ++i) {
    for (const std::uint16_t c : {0, 1}) {
      EXPECT_EQ(watch.place(CameraId(c), to_ns(i / 30.0), to_ns(100 + i / 30.0 + 0.01)), to_ns(i / 30.0)) << i;
    }
  }
}

// At twice the speed or half of it: lags change, but of all alike.
TEST_F(StampWatchTest, RecordingsMayPlayFasterOrSlower) {
  for (const double rate : {0.25, 0.5, 2.0, 4.0}) {
    StampWatch watch({kUtc_ns, -to_ns(100)});
    for (std::uint16_t c = 0; c < 3; ++c) watch.add(CameraId(c), "c", 30);
    for (int i = 0; i < 900; ++i) {
      for (std::uint16_t c = 0; c < 3; ++c) {
        EXPECT_TRUE(watch.place(CameraId(c), to_ns(i / 30.0), to_ns(100 + i / 30.0 / rate + 0.01))) << rate << ' ' << i;
      }
    }
  }
}

TEST_F(StampWatchTest, ExchangesCorrectWhatIsBelowASecond) {
  const auto exchange = [&](double at_s) {
    const auto agent_ns = [](double s) { return kUtc_ns + to_ns(s + 0.3); };
    watch_.exchange(CameraId(0), {to_ns(at_s), agent_ns(at_s + 0.003), agent_ns(at_s + 0.004), to_ns(at_s + 0.007)});
  };
  play(0, 1, [](double t) { return t + 0.3; });
  for (int i = 1; i < 10; ++i) exchange(i);
  auto out = play(10.5, 20, [](double t) { return t + 0.3; });
  expect_untouched(out);
  EXPECT_EQ(out[0].refused, 0);
  EXPECT_LT(out[0].worst_s, 0.002);
  EXPECT_THAT(warnings(), HasSubstr("the clock of agent cam0 is 300 ms ahead of"));
}

TEST(StampWatchRates, TenTimesTheAnnouncedRateIsThinned) {
  for (const double rate_hz : {30.0, 60.0, 300.0}) {
    StampWatch watch({0});
    watch.add(CameraId(0), "fast", 30);
    int used = 0;
    for (int i = 0; i < static_cast<int>(10 * rate_hz); ++i) {
      const TimeNs t_ns = to_ns(i / rate_hz);
      used += watch.place(CameraId(0), t_ns, t_ns).has_value() ? 1 : 0;
    }
    EXPECT_NEAR(used, 10 * std::min(rate_hz, 60.0), 3) << rate_hz;
  }
}

}  // namespace
}  // namespace coslam::stamp_watch_test
