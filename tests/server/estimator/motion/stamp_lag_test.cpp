// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/stamp_lag.h"

#include <gtest/gtest.h>

#include "tests/support/sim_map.h"

namespace coslam::stamp_lag_test {
namespace {

constexpr CameraId kFirst(0), kSecond(1), kThird(2);

// Three cameras at true poses, whose tracks of what moves are known to move, as each camera alone finds out.
class LagFinderTest : public testing::Test {
 protected:
  LagFinderTest() : sim_(world_, test::paths_side_by_side(3), {.noise_px = 0.15, .ends = 0.01, .max_tracks = 400}) {}

  int run(int sets) {
    int found = 0;
    for (int i = 0; i < sets; ++i) {
      sim_.advance();
      for (const CameraId c : {kFirst, kSecond, kThird}) {
        for (const auto& [id, t] : sim_.map.camera(c).tracks) {
          if (world_.moves(sim_.world_point(c, id)) && !t.moves()) sim_.edit.set_motion(c, t, TrackMotion::kMoving);
        }
      }
      found += lags_.run(sim_.edit).found;
    }
    return found;
  }

  const test::SimWorld world_{{.points = 50, .moving_points = 24}};
  test::SimMap sim_;
  StampLag lags_{StampLagConfig{}};
};

TEST_F(LagFinderTest, ACameraThatIsDatedHalfASecondEarlyIsFoundAndSaidOnce) {
  sim_.trackers[1].set_clock_behind(to_ns(0.5));
  int said = 0;
  for (int i = 0; i < 9; ++i) {
    run(100);
    for (const Event& e : sim_.edit.journal().events()) said += e.kind == EventKind::kCameraMisdated;
    sim_.edit.journal().begin_set();
  }
  ASSERT_TRUE(lags_.lag(kSecond));
  EXPECT_NEAR(lags_.lag(kSecond)->lag_s, 0.5, 0.08);
  EXPECT_FALSE(lags_.lag(kFirst));
  EXPECT_GE(said, 1);
}

TEST_F(LagFinderTest, ClocksThatAgreeAreLeftAlone) {
  EXPECT_EQ(run(900), 0);
  for (const CameraId c : {kFirst, kSecond, kThird}) EXPECT_FALSE(lags_.lag(c) && lags_.lag(c)->is_off());
}

TEST_F(LagFinderTest, AtTheEndAShortRunIsEnough) {
  sim_.trackers[1].set_clock_behind(to_ns(0.5));
  lags_.config.memory_s = 8;  // all repeats itself after 6 s
  run(200);
  EXPECT_FALSE(lags_.lag(kSecond)) << "no search has come to its end";
  lags_.finish(sim_.edit);
  ASSERT_TRUE(lags_.lag(kSecond));
  EXPECT_NEAR(lags_.lag(kSecond)->lag_s, 0.5, 0.08);
  EXPECT_EQ(lags_.lag(kSecond)->against, kFirst);
  EXPECT_TRUE(lags_.lag(kSecond)->is_off());
}

TEST_F(LagFinderTest, AnAgentThatBeginsAnewHasAnotherClock) {
  sim_.trackers[1].set_clock_behind(to_ns(0.5));
  run(900);
  ASSERT_TRUE(lags_.lag(kSecond));
  lags_.forget(kSecond);
  EXPECT_FALSE(lags_.lag(kSecond));
}

}  // namespace
}  // namespace coslam::stamp_lag_test
