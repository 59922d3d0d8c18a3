// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/tools/eval/doubts.h"

#include <gmock/gmock.h>

namespace coslam::eval {
namespace {

using ::testing::HasSubstr;

TEST(Doubts, ThatCannotJudgeSaysWhy) {
  constexpr TimeNs kGap_ns = 100'000'000;
  const auto path = [](double from_s, double to_s, double step_s = 0.1) {
    Trajectory t;
    for (double at_s = from_s; at_s <= to_s; at_s += step_s)
      t.push_back({to_ns(at_s), Rigid3(Eigen::Quaterniond::Identity(), {at_s, 0, 0})});
    return t;
  };
  EXPECT_THAT(why_not_judged("left", path(0.05, 4), path(0, 4, 2), kGap_ns),
              HasSubstr("the poses of the truth of agent left are 2.0 s apart"));
  Trajectory standing = path(0, 4);
  for (StampedPose& p : standing) p.cam_from_world = {};
  EXPECT_THAT(why_not_judged("left", path(0, 4), standing, kGap_ns),
              HasSubstr("the truth of agent left stays in one place"));
  EXPECT_EQ(why_not_judged("left", path(0, 4), path(3, 9), kGap_ns), "");
  EXPECT_EQ(why_not_judged("left", path(0, 4), {}, kGap_ns), "");
  EXPECT_EQ(why_not_judged("left", {}, path(0, 4), kGap_ns), "");
  EXPECT_THAT(
      why_not_judged("left", path(0, 4), path(100, 104), kGap_ns),
      HasSubstr("the poses of agent left are of 0.0 to 3.9 s of the time that was played, its truth of 100.0 to"));
}

}  // namespace
}  // namespace coslam::eval
