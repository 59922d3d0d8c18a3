// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/track_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace coslam::track_motion_test {
namespace {

int apart(Units a, Units b) { return std::max(std::abs(a.x - b.x), std::abs(a.y - b.y)); }

class TrackMotion : public testing::Test {
 protected:
  Units place() { return {std::uniform_int_distribution(-9000, 9000)(random_), number(-7000, 7000)}; }
  int number(int low, int high) { return std::uniform_int_distribution(low, high)(random_); }

  // Tracks that follow the motion up to a unit of noise; the first of them do not.
  std::vector<Step> steps_under(const MotionParameters& parameters, std::size_t count, std::size_t astray) {
    std::vector<Units> from(count);
    for (Units& at : from) at = place();
    centre_ = centre_of(from);
    const CommonMotion motion(centre_, parameters);
    std::vector<Step> steps;
    for (std::size_t i = 0; i < count; ++i) {
      const Units shift = motion.shift_at(from[i]);
      Units to{from[i].x + shift.x + number(-1, 1), from[i].y + shift.y + number(-1, 1)};
      if (i < astray) to = {to.x + number(-3000, 3000), to.y + number(-3000, 3000)};
      steps.push_back({from[i], to});
    }
    return steps;
  }

  std::mt19937 random_{3};
  Units centre_;
};

TEST_F(TrackMotion, IsFoundThoughAFifthOfTheTracksMovesOtherwise) {
  const MotionParameters truth{400, 900, -2500, -250, 2400, 1100, 700, -900};
  const std::vector<Step> steps = steps_under(truth, 300, 60);
  const CommonMotion found(centre_, fit_motion(centre_, steps));
  for (std::size_t i = 60; i < steps.size(); ++i) {
    const Units shift = found.shift_at(steps[i].from);
    EXPECT_LE(apart({steps[i].from.x + shift.x, steps[i].from.y + shift.y}, steps[i].to), 40) << i;
  }
}

TEST_F(TrackMotion, IsNoneWhereThereAreTooFewTracks) {
  const MotionParameters truth{400, 0, 0, -250, 0, 0, 0, 0};
  EXPECT_EQ(fit_motion({}, {}), MotionParameters{});
  EXPECT_EQ(fit_motion(centre_, steps_under(truth, 7, 0)), MotionParameters{});
  EXPECT_NEAR(fit_motion(centre_, steps_under(truth, 8, 0))[0], 400, 3);
}

TEST_F(TrackMotion, StaysInRangeWhateverTheTracksDo) {
  std::vector<Step> steps;
  for (int i = 0; i < 50; ++i) {
    const int side = i % 2 == 0 ? kMostUnits : -kMostUnits;
    steps.push_back({{side, -side}, {-side, side}});
  }
  const CommonMotion crossing({}, fit_motion({}, steps));
  EXPECT_LT(crossing.shift_at({kMostUnits, -kMostUnits}).x, 0);
  const std::vector<Step> one_place(20, Step{{5, 5}, {25, -15}});
  const CommonMotion together({5, 5}, fit_motion({5, 5}, one_place));
  EXPECT_EQ(together.shift_at({5, 5}), (Units{20, -20})) << "of one place alone the shift is known";
}

TEST_F(TrackMotion, TheCentreIsTheMean) {
  EXPECT_EQ(centre_of({}), Units{});
  EXPECT_EQ(centre_of({{10, -4}, {20, 4}, {30, 30}}), (Units{20, 10}));
  EXPECT_EQ(centre_of(std::vector<Units>(2000, {kMostUnits, -kMostUnits})), (Units{kMostUnits, -kMostUnits}));
}

TEST_F(TrackMotion, TheShiftIsThatOfTheFormula) {
  const CommonMotion motion({100, -50}, {7, 1 << 14, -(1 << 13), -9, 1 << 12, 1 << 14, 1 << 13, -(1 << 12)});
  for (int i = 0; i < 200; ++i) {
    const Units at = place();
    const double u = at.x - 100, v = at.y + 50, second = ((1 << 13) * u - (1 << 12) * v) / std::exp2(29);
    const double dx = 7 + ((1 << 14) * u - (1 << 13) * v) / std::exp2(16) + u * second;
    const double dy = -9 + ((1 << 12) * u + (1 << 14) * v) / std::exp2(16) + v * second;
    const Units shift = motion.shift_at(at);
    EXPECT_NEAR(shift.x, dx, 0.501);
    EXPECT_NEAR(shift.y, dy, 0.501);
  }
}

TEST_F(TrackMotion, WhatNeighboursDeviateByIsExpectedToo) {
  TrackPredictor predictor(CommonMotion({}, {}), 4);
  for (int i = 0; i < 3; ++i) {
    const Units from{100 + 10 * i, 0};
    predictor.predict(from);
    predictor.observe({from.x + 60, from.y - 30});
  }
  const Units near = predictor.predict({115, 5}), far = predictor.predict({20'000, 20'000});
  EXPECT_LE(apart(near, {115 + 60, 5 - 30}), 3);
  EXPECT_LE(apart(far, {20'000, 20'000}), 1) << "nobody is near";
}

TEST_F(TrackMotion, PredictionsStayInRange) {
  MotionParameters away{};
  away[0] = 30'000, away[3] = -30'000;
  TrackPredictor predictor(CommonMotion({}, away), 1);
  EXPECT_EQ(predictor.predict({kMostUnits, -kMostUnits}), (Units{kMostUnits, -kMostUnits}));
  predictor.observe({-kMostUnits, kMostUnits});
  const Units next = predictor.predict({kMostUnits - 1, -kMostUnits});
  EXPECT_LE(std::abs(next.x), kMostUnits);
  EXPECT_LE(std::abs(next.y), kMostUnits);
}

TEST_F(TrackMotion, TracksBeyondTheFirst512AreNoNeighbours) {
  TrackPredictor predictor(CommonMotion({}, {}), 2000);
  for (int i = 0; i < 512; ++i) {
    predictor.predict({0, 0});
    predictor.observe({0, 0});
  }
  for (int i = 0; i < 10; ++i) {
    predictor.predict({9000, 9000});
    predictor.observe({9100, 9100});
  }
  EXPECT_EQ(predictor.predict({9000, 9000}), (Units{9000, 9000}));
}

}  // namespace
}  // namespace coslam::track_motion_test
