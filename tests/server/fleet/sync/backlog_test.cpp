// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/sync/backlog.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

namespace coslam::backlog_test {
namespace {

using testing::ElementsAre;

constexpr CameraId kA(0), kB(1), kMany(2);
constexpr TimeNs kMs = 1'000'000;

FrameSet set_of(TimeNs t_ns, const std::vector<CameraId>& cameras) {
  FrameSet set{SetId(static_cast<std::uint32_t>(t_ns / kMs)), t_ns, {}};
  for (const CameraId c : cameras) set.frames.push_back({c, {}, {}, {}});
  return set;
}

class BacklogTest : public testing::Test {
 protected:
  void push(TimeNs t_ns, const std::vector<CameraId>& cameras) { backlog_.push(set_of(t_ns, cameras)); }
  std::vector<std::uint32_t> work_off() {
    std::vector<std::uint32_t> ids;
    while (const auto set = backlog_.pop()) ids.push_back(set->id.value);
    return ids;
  }
  Backlog backlog_;
};

TEST_F(BacklogTest, OfEqualsTheOldestAreLeftOut) {
  for (int i = 0; i < 5; ++i) push(i * kMs, {kA, kB});
  EXPECT_EQ(backlog_.thin(3).size(), 2U);
  EXPECT_THAT(work_off(), ElementsAre(2, 3, 4));
  EXPECT_TRUE(backlog_.empty());
  EXPECT_EQ(backlog_.thin(0).size(), 0U);
}

// One that sends eight frames for one of the others, and a server that has time for two sets of nine.
TEST_F(BacklogTest, WhoSendsMoreThanTheOthersPaysForIt) {
  std::map<CameraId, int> sets;
  int others = 0;
  for (int i = 0; i < 900; ++i) {
    const bool all = i % 9 == 0;
    others += all;
    push(i * 4 * kMs, all ? std::vector{kA, kB} : std::vector{kMany});
    backlog_.thin(12);
    if (i % 9 != 0 && i % 9 != 4) continue;
    const auto set = backlog_.pop();
    for (const CameraFrame& f : set->frames) ++sets[f.camera];
  }
  EXPECT_GT(sets[kA], 0.95 * others);
  EXPECT_EQ(sets[kB], sets[kA]);
  EXPECT_GT(sets[kMany], 0.9 * (200 - others));
}

TEST_F(BacklogTest, WhatWasAskedForRidesWithTheNextFrameOfItsAgent) {
  FrameSet first = set_of(1 * kMs, {kA, kB});
  first.frames[0].patches = PatchReply{.agent = "a", .agent_run = RunId(1), .frame = FrameId(1), .patches = {}};
  backlog_.push(first);
  push(2 * kMs, {kB});
  push(3 * kMs, {kA, kB});
  EXPECT_EQ(backlog_.thin(2).size(), 1U);
  EXPECT_EQ(backlog_.pop()->id, SetId(2));
  const auto last = backlog_.pop();
  ASSERT_TRUE(last->frames[0].patches);
  EXPECT_EQ(last->frames[0].patches->frame, FrameId(1));
  EXPECT_FALSE(last->frames[1].patches);
}

}  // namespace
}  // namespace coslam::backlog_test
