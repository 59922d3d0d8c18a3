// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/evaluation_text.h"

#include <gmock/gmock.h>

#include <sstream>
#include <string>
#include <vector>

namespace coslam::eval::evaluation_text_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

AgentEvaluation agent(const std::string& name) {
  AgentEvaluation a;
  a.name = name;
  a.frames = 100;
  a.poses = a.judged = 90;
  a.judged_s = a.poses_s = 9;
  a.tracked_percent = 90;
  a.path_m = 10;
  a.ate_m = 0.0123;
  a.own_scale = 1.0;
  return a;
}

// Of two agents with truth.
Evaluation two_agents() {
  Evaluation e;
  e.sequence = "walk";
  e.agents = {agent("left"), agent("right")};
  e.alignment.target_from_source = Similarity3{2, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()};
  e.ate_m = 0.0123;
  e.ate_percent = 0.06;
  e.path_m = 20;
  e.tracked_percent = 90;
  e.truth_spread_m = 3;
  return e;
}

// The words of the line that begins with this one.
std::vector<std::string> row_of(const Evaluation& e, const std::string& first) {
  std::istringstream text(to_text(e));
  for (std::string line; std::getline(text, line);) {
    std::istringstream stream(line);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    if (!words.empty() && words.front() == first) return words;
  }
  return {};
}

TEST(EvaluationText, TheHeadlineHasTheJointError) {
  Evaluation e = two_agents();
  EXPECT_THAT(to_text(e), StartsWith("walk\n  joint ATE 0.0123 m, 0.060 % of 20.00 m; scale 2.00000; 90.0 % of the "
                                     "images tracked\n"));
  e.live_ate_m = 0.05;
  EXPECT_THAT(to_text(e), HasSubstr("tracked; live ATE 0.0500 m\n"));
  e.ate_percent = e.path_m = e.tracked_percent = e.live_ate_m = std::nullopt;
  EXPECT_THAT(to_text(e), HasSubstr("  joint ATE 0.0123 m; scale 2.00000\n"));
}

TEST(EvaluationText, AnAgentHasARowAndADashForWhatIsNotKnown) {
  Evaluation e = two_agents();
  e.agents[1] = {.name = "right", .judged = 1};
  e.agents[0].motion = MotionError{.translation_rmse_m = 0.02, .rotation_rmse_deg = 0.5};
  EXPECT_THAT(row_of(e, "left"), ElementsAre("left", "90.0", "0.0123", "-", "-", "-", "0.0200", "0.500", "-", "10.00"));
  EXPECT_THAT(row_of(e, "right"), ElementsAre("right", "-", "-", "-", "-", "-", "-", "-", "-", "-"));
}

TEST(EvaluationText, WhatIsNotWhatItSeemsIsSaid) {
  Evaluation e = two_agents();
  EXPECT_THAT(to_text(e), AllOf(Not(HasSubstr("LITTLE")), Not(HasSubstr("judged on"))));
  e.truth_spread_m = 0.02;
  e.agents[0].judged = 80;
  e.agents[0].judged_s = 8;
  e.agents[1].doubts = {"the truth of agent right is upside down"};
  e.agents[1].images[ImageFate::kTracked] = 90;
  e.agents[1].images[ImageFate::kLost] = 10;
  EXPECT_THAT(to_text(e),
              AllOf(HasSubstr("says LITTLE of where the cameras were: their true places are spread by 0.0200"),
                    HasSubstr("left is judged on 80 of 90 poses, 8.0 of 9.0 s"),
                    HasSubstr("  the truth of agent right is upside down\n"),
                    HasSubstr("right: of 100 images 10 lost on the way")));
}

TEST(EvaluationText, WithoutTruthThereAreCountsAlone) {
  Evaluation e;
  e.sequence = "walk";
  e.problem = "fewer than three pairs";
  e.agents = {{.name = "left"}, {.name = "right"}};
  e.agents[0].tracked_percent = 55;
  EXPECT_THAT(to_text(e), AllOf(HasSubstr("there is no truth"), Not(HasSubstr("ATE"))));
  EXPECT_THAT(row_of(e, "left"), ElementsAre("left", "55.0", "%", "of", "its", "images", "tracked"));
  EXPECT_THAT(row_of(e, "right"), ElementsAre("right", "-", "%", "of", "its", "images", "tracked"));
  e.agents[1].judged = 2;
  EXPECT_THAT(to_text(e), HasSubstr("  no absolute error: fewer than three pairs with truth\n"));
}

TEST(EvaluationText, MapsApartAndWrongMergesAreNamed) {
  Evaluation e = two_agents();
  e.maps = {{MapId(), {"left"}, 0.01, 0.1, 1.5}, {MapId(5), {"far", "right"}, {}, {}, {}}};
  EXPECT_THAT(to_text(e), AllOf(HasSubstr("2 maps without a known relation"),
                                HasSubstr("  map of left: ATE 0.0100 m, scale 1.50000\n"),
                                HasSubstr("  map of far right: ATE -\n")));
  e.maps.resize(1);
  EXPECT_THAT(to_text(e), Not(HasSubstr("map of")));
}

TEST(EvaluationText, AWrongMergeHasTheReasonThatItMayHave) {
  Evaluation e = two_agents();
  e.wrong_merges = {{"left", "right"}};
  EXPECT_THAT(to_text(e),
              HasSubstr("WRONG MERGE: left and right do not fit together, though each alone follows its truth; "
                        "or their truths are not of one frame"));
  e.agents[1].own_scale = 0.3048;
  EXPECT_THAT(to_text(e), HasSubstr("; by scale they differ 3.281 times: is one truth in other units?\n"));
  for (const std::optional<double>& scale : {std::optional<double>(), std::optional(0.0), std::optional(-1.0)}) {
    e.agents[1].own_scale = scale;
    EXPECT_THAT(to_text(e), HasSubstr("each alone follows its truth\n"));
  }
  e.wrong_merges = {{"left", "nobody"}};
  EXPECT_THAT(to_text(e), HasSubstr("left and nobody do not fit together, though each alone follows its truth\n"));
}

TEST(EvaluationText, ChangesOfGroupsAreListedWithTheirDelays) {
  Evaluation e = two_agents();
  GroupScore score;
  TrueOverlap::Change merge;
  merge.t_ns = 5'000'000'000;
  merge.merge = true;
  merge.first = {"left"}, merge.second = {"right", "third"};
  TrueOverlap::Change split = merge;
  split.t_ns = 9'000'000'000;
  split.merge = false;
  score.changes = {{merge, 0.25}, {split, std::nullopt}};
  score.false_changes = {{12'000'000'000, true, {"left"}, {"right"}}};
  score.shortest_state_s = 1.5;
  e.groups = score;
  EXPECT_THAT(
      to_text(e),
      AllOf(HasSubstr("groups: 0 of 1 splits and 1 of 1 merges found, 0 false splits, 1 false merges; "
                      "worst delay 0.25 s; shortest state 1.50 s\n"),
            HasSubstr("    5.0 s left + right third: +0.25 s\n"), HasSubstr("    9.0 s left | right third: missed\n"),
            HasSubstr("    12.0 s left + right: false\n")));
  e.groups = GroupScore();
  EXPECT_THAT(to_text(e), EndsWith("groups: 0 of 0 splits and 0 of 0 merges found, 0 false splits, 0 false merges\n"));
}

TEST(EvaluationText, WhatMovesHasItsFigures) {
  Evaluation e = two_agents();
  e.classification =
      ClassificationScore{.precision = 0.9, .recall = 0.8, .static_on_moving = 0.05, .observations = 400};
  e.dynamic_error_m = ErrorSpread{0.01, 0.03, 20};
  e.dynamic_surface_error_m = ErrorSpread{0.02, 0.04, 30};
  e.dynamic_relative_error = ErrorSpread{0.005, 0.02, 30};
  e.dynamic_length_s = 2.5;
  e.bodies["plate"] = {
      .instants = 10, .covered = 8, .object_instants = 4, .objects_found = 3, .velocity_errors_m_s = {0.1}};
  EXPECT_THAT(
      to_text(e),
      AllOf(HasSubstr("precision 90.0 %, recall 80.0 %, taken for static 5.0 %, false alarms - (400 observations)"),
            HasSubstr("0.0100 m median, 0.0300 m p90 to the marked ones (20)"),
            HasSubstr("0.0200 m median, 0.0400 m p90 to the true surface (30)"),
            HasSubstr("0.5 % median, 2.0 % p90 of the distance to the nearest camera (30)"),
            HasSubstr("followed for 2.50 s in the median"),
            EndsWith("  plate: moving points at 80.0 % of 10 instants; one object at 75.0 % of 4, its velocity "
                     "0.100 m/s off\n")));
  e.bodies["cart"] = {};
  EXPECT_THAT(to_text(e), AllOf(HasSubstr("  cart: moving points at - of 0 instants\n"),
                                HasSubstr("  all: moving points at 80.0 % of 10 instants")));
}

TEST(EvaluationText, PointsAndTheRelativePoseHaveALineEach) {
  Evaluation e = two_agents();
  e.points = PointAccuracy{.count = 20, .error_median_m = 0.01, .error_p90_m = 0.02, .nees_median = 2, .nees_p90 = 6};
  e.relative_pose = RelativePoseError{1, 0.02, 0.3, 2.0, 55};
  EXPECT_THAT(to_text(e),
              AllOf(HasSubstr("static points: 0.0100 m median, 0.0200 m p90; NEES 2.00 median, 6.00 p90"),
                    HasSubstr("left to right: 1.0000 m as it stands, 0.0200 m scaled, 0.300 deg, medians of 55 (true "
                              "distance 2.000 m)")));
}

}  // namespace
}  // namespace coslam::eval::evaluation_text_test
