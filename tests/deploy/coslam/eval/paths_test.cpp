// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <utility>

#include "common/base/error.h"
#include "deploy/coslam/eval/evaluation.h"
#include "tests/support/temp_folder.h"

namespace coslam::eval::paths_test {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

constexpr double kRate_hz = 10;
constexpr int kFrames = 60;

// A true path on a loop of some metres, and what a run made of it.
class PathsOfAgents : public ::testing::Test {
 protected:
  static Rigid3 true_pose(int agent, int frame) {
    const double t = 0.1 * frame;
    return Rigid3(so3_exp({0.1 * std::sin(t), 0.4 * t, 0}),
                  {2 * std::cos(0.7 * t) + agent, 0.4 * std::sin(1.3 * t), 2 * std::sin(0.7 * t)})
        .inverse();
  }
  static Trajectory truth(int agent) {
    Trajectory out;
    for (int i = 0; i < kFrames; ++i) out.push_back({i * 100'000'000LL, true_pose(agent, i)});
    return out;
  }
  // Exact but for noise, in a frame of its own.
  Trajectory estimate(int agent, const Similarity3& truth_from_map, double noise_m = 0) {
    std::normal_distribution<double> noise(0, 1);
    Trajectory out = truth(agent);
    for (StampedPose& pose : out) {
      pose.cam_from_world.translation += noise_m * Eigen::Vector3d(noise(random_), noise(random_), noise(random_));
      pose.cam_from_world = transform_world(pose.cam_from_world, truth_from_map.inverse());
    }
    return out;
  }
  AgentPaths agent(int number, const Similarity3& truth_from_map, double noise_m = 0) {
    AgentPaths out;
    out.name = std::string(1, static_cast<char>('a' + number));
    out.truth = truth(number);
    out.estimate = estimate(number, truth_from_map, noise_m);
    return out;
  }

  std::mt19937 random_{2};
  const Similarity3 map_a_{2, so3_exp({0.3, 0, 0.5}), {1, 2, 3}}, map_b_{0.5, so3_exp({0, 1, 0}), {-4, 0, 1}};
};

TEST_F(PathsOfAgents, NoiseIsTheErrorAndTheScaleIsFound) {
  std::vector<AgentPaths> agents{agent(0, map_a_, 0.02), agent(1, map_a_, 0.02)};
  const Evaluation e = evaluate_paths(agents, kRate_hz);
  ASSERT_TRUE(e.ate_m);
  EXPECT_NEAR(*e.ate_m, 0.02 * std::sqrt(3), 0.006);
  EXPECT_NEAR(e.alignment.target_from_source->scale, 2, 0.02);
  EXPECT_NEAR(*e.ate_percent, 100 * *e.ate_m / *e.path_m, 1e-9);
  EXPECT_EQ(*e.tracked_percent, 100);
  EXPECT_FALSE(e.live_ate_m) << "there are no live poses";
  for (const AgentEvaluation& a : e.agents) {
    EXPECT_LE(*a.ate_own_m, *a.ate_m + 1e-3) << "an alignment of its own is no worse";
    EXPECT_EQ(a.judged, kFrames);
    EXPECT_NEAR(a.judged_s, 0.1 * (kFrames - 1), 1e-9);
    EXPECT_NEAR(*a.path_m, path_length(truth(0)), 1e-9);
  }
  EXPECT_TRUE(e.relative_pose);
}

TEST_F(PathsOfAgents, LivePosesAreJudgedUnderTheirOwnAlignment) {
  std::vector<AgentPaths> agents{agent(0, map_a_), agent(1, map_a_)};
  for (int i = 0; i < 2; ++i) agents[static_cast<std::size_t>(i)].live = estimate(i, map_b_, 0.05);
  const Evaluation e = evaluate_paths(agents, kRate_hz);
  EXPECT_LT(*e.ate_m, 1e-6);
  EXPECT_NEAR(*e.live_ate_m, 0.05 * std::sqrt(3), 0.015);
  EXPECT_NEAR(*e.live_scale, 0.5, 0.02);
  EXPECT_TRUE(e.agents[1].live_worst);
  EXPECT_GT(*e.live_ate_percent, 0);
}

TEST_F(PathsOfAgents, ImagesThatAreKnownCountNotThoseOfTheTruth) {
  std::vector<AgentPaths> agents{agent(0, map_a_)};
  agents[0].frames = 120;
  agents[0].doubt = "the truth of agent a is upside down";
  const Evaluation e = evaluate_paths(agents, kRate_hz);
  EXPECT_EQ(*e.agents[0].tracked_percent, 50);
  EXPECT_THAT(e.agents[0].doubts, ::testing::Contains("the truth of agent a is upside down"));
  EXPECT_FALSE(e.relative_pose) << "there is one agent alone";
}

TEST_F(PathsOfAgents, WithoutTruthOrPosesThereAreCountsAlone) {
  AgentPaths blind = agent(0, map_a_), lost = agent(1, map_a_);
  blind.truth.clear();
  lost.estimate.clear();
  const Evaluation e = evaluate_paths({blind, lost}, kRate_hz);
  EXPECT_FALSE(e.ate_m);
  EXPECT_NE(e.problem, "");
  EXPECT_EQ(e.agents[0].poses, kFrames);
  EXPECT_EQ(e.agents[0].judged, 0);
  EXPECT_FALSE(e.agents[0].tracked_percent) << "how many images there were is not known";
  EXPECT_EQ(e.agents[1].tracked_percent, 0);
  EXPECT_FALSE(e.agents[1].ate_own_m);
  const Evaluation nothing = evaluate_paths({}, kRate_hz);
  EXPECT_FALSE(nothing.path_m);
  EXPECT_FALSE(nothing.tracked_percent);
}

TEST_F(PathsOfAgents, MapsThatAreJoinedWronglyAreToldByTwo) {
  // In one map, though each has a scale and a place of its own.
  const std::vector<AgentPaths> wrong{agent(0, map_a_, 0.01), agent(1, map_b_, 0.01), agent(2, map_a_, 0.01)};
  Evaluation e;
  evaluate_maps(e, wrong, {{"a", "b", "c"}}, kRate_hz);
  ASSERT_EQ(e.maps.size(), 1U);
  EXPECT_THAT(e.wrong_merges, ElementsAre(Pair("a", "b"), Pair("b", "c")));

  const std::vector<AgentPaths> good{agent(0, map_a_, 0.01), agent(1, map_a_, 0.01)};
  Evaluation fine;
  evaluate_maps(fine, good, {{"a", "b"}}, kRate_hz);
  EXPECT_TRUE(fine.wrong_merges.empty());
  EXPECT_NEAR(*fine.maps.at(0).scale, 2, 0.02);
}

TEST_F(PathsOfAgents, OneThatIsLostByItselfIsNoWrongMerge) {
  std::vector<AgentPaths> agents{agent(0, map_a_, 0.01), agent(1, map_a_, 2.0)};
  Evaluation e;
  evaluate_maps(e, agents, {{"a", "b"}}, kRate_hz);
  EXPECT_TRUE(e.wrong_merges.empty());
  EXPECT_GT(*e.maps.at(0).ate_m, 0.5);
}

TEST_F(PathsOfAgents, AMapApartIsJudgedWithThoseInItAlone) {
  std::vector<AgentPaths> agents{agent(0, map_a_), agent(1, map_b_), agent(2, map_b_)};
  for (std::size_t i : {1U, 2U}) agents[i].apart[MapId(5)] = std::exchange(agents[i].estimate, {});
  Evaluation e;
  evaluate_maps(e, agents, {{"a", "b"}, {"c"}}, kRate_hz);
  ASSERT_EQ(e.maps.size(), 2U) << "who was never in the common map is not judged there";
  EXPECT_EQ(e.maps[0].agents, AgentNames{"a"});
  EXPECT_EQ(e.maps[1].id, MapId(5));
  EXPECT_EQ(e.maps[1].agents, (AgentNames{"b", "c"}));
  EXPECT_LT(*e.maps[1].ate_m, 1e-6);
  EXPECT_NEAR(*e.maps[1].scale, 0.5, 1e-6);
  EXPECT_EQ(evaluate_paths(agents, kRate_hz).agents[1].poses_apart, kFrames);
}

TEST_F(PathsOfAgents, TruthIsInterpolatedOverAFewImagesAtMost) {
  EXPECT_EQ(max_gap_ns(30), 100'000'000);
  EXPECT_EQ(max_gap_ns(5), 500'000'000);
  std::vector<AgentPaths> agents{agent(0, map_a_)};
  std::erase_if(agents[0].truth, [](const StampedPose& p) { return p.t_ns > 1'000'000'000 && p.t_ns < 2'000'000'000; });
  EXPECT_EQ(evaluate_paths(agents, kRate_hz).agents[0].judged, kFrames - 9);
}

class LoadedPaths : public ::testing::Test {
 protected:
  LoadedPaths() {
    sequence_.file = temp_ / "sequence.yaml";
    sequence_.rate_hz = kRate_hz;
    sequence_.agents.push_back({.name = "a"});
    sequence_.agents.push_back({.name = "b"});
    save_tum(result_.trajectory("a"), {{0, Rigid3()}, {100'000'000, Rigid3()}});
  }
  test::TempFolder temp_;
  ResultFolder result_{temp_ / "result"};
  Sequence sequence_;
};

TEST_F(LoadedPaths, WithoutAReportAllAgentsOfTheSequenceCount) {
  const auto agents = load_paths(result_, sequence_);
  ASSERT_EQ(agents.size(), 2U);
  EXPECT_EQ(agents[0].estimate.size(), 2U);
  EXPECT_TRUE(agents[0].live.empty());
  EXPECT_EQ(agents[0].frames, 0);
  EXPECT_TRUE(agents[1].estimate.empty());
}

TEST_F(LoadedPaths, AReportMaySayNothingOfItsFrames) {
  for (const char* text :
       {R"({"agents": {"a": {"frames": 31}, "b": {}}})", R"({"agents": {"a": {"frames": 31}, "b": 5}})",
        R"({"agents": {"a": {"frames": 31}, "b": {"frames": "many", "images": 3}}})"}) {
    temp_.write("result/report.json", text);
    const auto agents = load_paths(result_, sequence_);
    ASSERT_EQ(agents.size(), 2U) << text;
    EXPECT_EQ(agents[0].frames, 31) << text;
    EXPECT_EQ(agents[1].frames, 0) << text;
  }
}

TEST_F(LoadedPaths, AResultOfOtherAgentsIsNamedWithItsSequence) {
  std::filesystem::rename(result_.trajectory("a"), result_.trajectory("z"));
  const std::string error = test::error_of<UserError>([&] { load_paths(result_, sequence_); });
  EXPECT_EQ(error,
            result_.path().string() + ": there is no trajectory/<agent>.tum of an agent of " + sequence_.file.string());
}

}  // namespace
}  // namespace coslam::eval::paths_test
