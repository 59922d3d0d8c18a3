// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/doubts.h"

#include <gmock/gmock.h>

#include "common/dataset/trajectory.h"
#include "tests/support/temp_folder.h"

namespace coslam::eval::doubts_test {
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

// Turns and moves, 40 degrees and a metre a second.
AgentPaths turning() {
  AgentPaths agent{.name = "left"};
  for (int i = 0; i < 60; ++i) {
    const Eigen::AngleAxisd turn(0.7 * i / 30.0, Eigen::Vector3d(0.2, 0.9, 0.4).normalized());
    agent.estimate.push_back({to_ns(i / 30.0), Rigid3(Eigen::Quaterniond(turn), {i / 30.0, 0.3, 0})});
  }
  return agent;
}

TEST(Doubts, TurnsOfPosesFromTheWorldToTheCamera) {
  test::TempFolder folder;
  AgentPaths agent = turning();
  for (const bool inverse : {false, true}) {
    agent.truth = agent.estimate;
    for (StampedPose& p : agent.truth) p.cam_from_world = inverse ? p.cam_from_world.inverse() : p.cam_from_world;
    save_tum(folder / "truth.tum", agent.truth);
    SequenceAgent listed;
    listed.truth = folder / "truth.tum";
    const std::string doubt = doubt_of_turns(agent, listed, 30);
    if (inverse) {
      EXPECT_THAT(doubt, HasSubstr("as if its poses were from the world to the camera (0.0 deg then)"));
    } else {
      EXPECT_EQ(doubt, "");
    }
  }
}

TEST(Doubts, TruthThatIsTooFastForMetres) {
  AgentPaths agent = turning();
  agent.truth = agent.estimate;
  EXPECT_EQ(doubt_of_unit(agent), "");
  for (StampedPose& p : agent.truth) p.cam_from_world.translation *= 1000;
  EXPECT_THAT(doubt_of_unit(agent), HasSubstr("m/s: is it in millimetres?"));
}

}  // namespace
}  // namespace coslam::eval::doubts_test
