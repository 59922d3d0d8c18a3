// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/ask.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "tests/support/sim_map.h"

namespace coslam::ask_test {
namespace {

using Waiting = Verification::Waiting;

// One camera that turns as a test wants, asked at each of 30 sets a second; it answers at once.
class AskTest : public testing::Test {
 protected:
  struct Asked {
    SetId set;
    DescriptorRequest request;
  };
  // turn_rad_s: of the camera, which is placed unless told otherwise.
  std::vector<Asked> run(double time_s, double turn_rad_s, const std::function<WhyAsk(int)>& why, bool placed = true) {
    test::SimMap sim(world_, {[=](double t_s) { return test::looking({0, 0, 2}, turn_rad_s * t_s); }});
    const MapCamera& camera = sim.map.camera(CameraId(0));
    std::vector<Asked> out;
    int asked_at = 0;
    for (int i = 0; i < 30 * time_s; ++i) {
      sim.ingest();
      if (placed) sim.place_truly();
      if (placed && i == 0) sim.add_points();
      if (!out.empty() && i == asked_at + answer_sets_) asking_.came(camera.id, sim.set.id);
      const DescriptorRequest r = asking_.ask(sim.map, camera, why(i));
      if (r == DescriptorRequest::kNone) continue;
      out.push_back({sim.set.id, r});
      asked_at = i;
    }
    sets_in_soon_ = sim.map.sets_in(config_.soon_s);
    return out;
  }
  static WhyAsk nothing(int) { return {}; }
  // The least number of sets between two requests.
  static std::uint32_t least_gap(const std::vector<Asked>& asked) {
    std::uint32_t least = 1U << 30U;
    for (std::size_t i = 1; i < asked.size(); ++i) least = std::min(least, asked[i].set.value - asked[i - 1].set.value);
    return least;
  }

  const test::SimWorld world_{{}};
  AskConfig config_;
  Asking asking_{config_};
  std::uint32_t sets_in_soon_ = 0;
  int answer_sets_ = 1;  // until an answer is there; 1 in lock-step
};

TEST_F(AskTest, ACameraWithoutAMapDescribesAllOfItsImageSoon) {
  const auto asked = run(2, 0, nothing, false);
  EXPECT_EQ(asked.size(), 10U);
  EXPECT_EQ(least_gap(asked), sets_in_soon_);
  for (const Asked& a : asked) EXPECT_EQ(a.request, DescriptorRequest::kEverywhere);
}

TEST_F(AskTest, IsNotAskedAgainWhileTheAnswerIsOnItsWay) {
  answer_sets_ = 15;
  EXPECT_EQ(run(3, 0, nothing, false).size(), 6U) << "each half a second";
  asking_ = Asking(config_);
  answer_sets_ = 1000;
  EXPECT_EQ(run(3, 0, nothing, false).size(), 3U) << "lost: again after a second";
}

TEST_F(AskTest, ACameraThatStandsStillIsAskedOnce) {
  const auto asked = run(10, 0, nothing);
  ASSERT_EQ(asked.size(), 1U);
  EXPECT_EQ(asked[0].request, DescriptorRequest::kAtTracks);
}

TEST_F(AskTest, AnotherViewIsAskedForASecondLaterAtTheEarliest) {
  const auto asked = run(3.5, 1, nothing);
  EXPECT_EQ(asked.size(), 4U) << "three ahead and one and a half in that time";
  EXPECT_GE(least_gap(asked), 30U);
}

TEST_F(AskTest, InTheLongRunTheBudgetHolds) {
  const double time_s = 30;
  const auto asked = run(time_s, 1, nothing);
  EXPECT_LE(static_cast<double>(asked.size()), config_.image_burst + config_.images_per_s * time_s);
  EXPECT_GE(static_cast<double>(asked.size()), config_.images_per_s * time_s);
}

TEST_F(AskTest, WhereGroupsHavePartedHalfTheChangeIsEnough) {
  const auto parted = [](int) { return WhyAsk{.parted = true}; };
  const auto asked = run(1.4, 0.4, parted);
  EXPECT_EQ(asked.size(), 3U);
  EXPECT_LT(least_gap(asked), 30U);
  EXPECT_EQ(Asking(config_).ask(test::SimMap(world_, {test::still_path({})}).map, MapCamera{}, {}),
            DescriptorRequest::kEverywhere)
      << "one that was never seen has no map";
}

TEST_F(AskTest, WhileThereAreSeveralMapsTheViewNeedNotChange) {
  const auto asked = run(1.4, 0, [](int) { return WhyAsk{.apart = true}; });
  ASSERT_EQ(asked.size(), 3U) << "every half second";
  for (const Asked& a : asked) EXPECT_EQ(a.request, DescriptorRequest::kEverywhere);
}

TEST_F(AskTest, WhatWaitsToBeConfirmedMayRunIntoDebt) {
  const auto waits = [](int) { return WhyAsk{.waiting = Waiting::kExpected}; };
  const auto asked = run(2, 0, waits);
  EXPECT_EQ(least_gap(asked), sets_in_soon_);
  EXPECT_GT(static_cast<double>(asked.size()), config_.image_burst + config_.images_per_s * 2);
  EXPECT_LE(static_cast<double>(asked.size()), 2 * config_.image_burst + config_.images_per_s * 2);
  for (const Asked& a : asked) EXPECT_EQ(a.request, DescriptorRequest::kAtTracks) << "near where it is expected";
}

TEST_F(AskTest, ADebtIsPaidBeforeTheNext) {
  const double debt_s = (config_.image_burst + 1) / config_.images_per_s;  // from the bottom until an image can be had
  const auto asked = run(2 * debt_s, 0, [](int) { return WhyAsk{.waiting = Waiting::kAnywhere, .apart = true}; });
  std::uint32_t longest_gap = 0;
  for (std::size_t i = 1; i < asked.size(); ++i) {
    longest_gap = std::max(longest_gap, asked[i].set.value - asked[i - 1].set.value);
  }
  EXPECT_GT(longest_gap, 30 * (debt_s - 1 / config_.images_per_s)) << "or it stays at the bottom for good";
  EXPECT_LE(longest_gap, 30 * debt_s);
}

TEST_F(AskTest, MoreOfTheSameGroundIsAskedForWhenAnotherPartIsInView) {
  const auto more = [](int) { return WhyAsk{.waiting = Waiting::kMore, .apart = true}; };
  EXPECT_EQ(run(4, 0, more).size(), 1U) << "it stands still";
  asking_ = Asking(config_);
  const auto turning = run(6, 0.3, more);
  EXPECT_GE(least_gap(turning), 15U) << "half the usual change of the view";
  EXPECT_GT(turning.size(), 3U);
  EXPECT_LE(static_cast<double>(turning.size()), config_.image_burst + config_.images_per_s * 6 + 1) << "without debt";
}

TEST_F(AskTest, WhatMayBeAnywhereIsDescribedEverywhere) {
  const auto asked = run(0.5, 0, [](int) { return WhyAsk{.waiting = Waiting::kAnywhere}; });
  ASSERT_FALSE(asked.empty());
  for (const Asked& a : asked) EXPECT_EQ(a.request, DescriptorRequest::kEverywhere);
}

TEST_F(AskTest, AHintIsLookedAtCloselyForAWhile) {
  asking_.hint(CameraId(0), SetId(0));
  const auto asked = run(3, 0, nothing);
  ASSERT_GE(asked.size(), 3U);
  for (const Asked& a : asked) {
    EXPECT_EQ(a.request, DescriptorRequest::kEverywhere);
    EXPECT_LT(a.set.value, 30 * config_.least_period_s);
  }
}

TEST_F(AskTest, ACameraThatShouldSeeWhatAnotherSeesIsAskedSoon) {
  const auto asked = run(1, 0, [](int) { return WhyAsk{.expects = true}; });
  EXPECT_EQ(asked.size(), 3U) << "as far as the budget goes";
  EXPECT_EQ(least_gap(asked), sets_in_soon_);
}

}  // namespace
}  // namespace coslam::ask_test
