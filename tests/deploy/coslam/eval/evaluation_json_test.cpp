// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/evaluation_json.h"

#include <gtest/gtest.h>

#include <string>

namespace coslam::eval::evaluation_json_test {
namespace {

using nlohmann::ordered_json;

TEST(EvaluationJson, OfNothingEveryFigureIsNullAndEveryListEmpty) {
  const ordered_json json = to_json(Evaluation());
  for (const char* key : {"ate_m",
                          "ate_percent",
                          "scale",
                          "problem",
                          "path_m",
                          "truth_spread_m",
                          "rpe",
                          "tracked_percent",
                          "relative_pose",
                          "points",
                          "nees",
                          "classification",
                          "dynamic_error_m",
                          "dynamic_surface_error_m",
                          "dynamic_relative_error",
                          "dynamic_length_s",
                          "dynamic_coverage",
                          "object_found",
                          "object_velocity_error_m_s",
                          "groups"}) {
    ASSERT_TRUE(json.contains(key)) << key;
    EXPECT_TRUE(json[key].is_null()) << key;
  }
  for (const char* key : {"ate_m", "ate_percent", "scale"}) EXPECT_TRUE(json["live"].at(key).is_null()) << key;
  EXPECT_EQ(json["agents"], ordered_json::object());
  EXPECT_EQ(json["maps"], ordered_json::array());
  EXPECT_EQ(json["wrong_merges"], ordered_json::array());
  EXPECT_EQ(json["bodies"], ordered_json::object());
}

TEST(EvaluationJson, AnAgentHasItsFiguresUnderItsName) {
  Evaluation e;
  AgentEvaluation a;
  a.name = "left";
  a.frames = 100;
  a.poses = 90;
  a.ate_m = 0.01;
  a.motion = MotionError{.translation_rmse_m = 0.02, .rotation_rmse_deg = 0.5, .count = 8};
  a.worst = WorstFrame{.error_m = 0.3, .median_m = 0.01, .t_ns = 1'500'000'000};
  a.doubts = {"it is upside down"};
  e.agents = {a};
  ordered_json json = to_json(e)["agents"]["left"];
  EXPECT_EQ(json["frames"], 100);
  EXPECT_EQ(json["ate_m"], 0.01);
  EXPECT_TRUE(json["live_ate_m"].is_null());
  EXPECT_TRUE(json["images"].is_null()) << "the report told nothing of them";
  EXPECT_EQ(json["rpe"]["delta_s"], 1);
  EXPECT_EQ(json["rpe"]["translation_m"], 0.02);
  EXPECT_EQ(json["rpe"]["count"], 8);
  EXPECT_EQ(json["worst_frame"]["t_s"], 1.5);
  EXPECT_TRUE(json["live_worst_frame"].is_null());
  EXPECT_EQ(json["doubts"][0], "it is upside down");
  e.agents[0].images[ImageFate::kLost] = 7;
  json = to_json(e)["agents"]["left"];
  EXPECT_EQ(json["images"]["lost"], 7);
}

TEST(EvaluationJson, TheCommonMapHasNoNumber) {
  Evaluation e;
  e.maps = {{MapId(), {"left"}, 0.01, 0.1, 1.5}, {MapId(5), {"far", "right"}, {}, {}, {}}};
  e.wrong_merges = {{"far", "right"}};
  const ordered_json json = to_json(e);
  EXPECT_TRUE(json["maps"][0]["map"].is_null());
  EXPECT_EQ(json["maps"][0]["scale"], 1.5);
  EXPECT_EQ(json["maps"][1]["map"], 5);
  EXPECT_EQ(json["maps"][1]["agents"], ordered_json::parse(R"(["far", "right"])"));
  EXPECT_TRUE(json["maps"][1]["ate_m"].is_null());
  EXPECT_EQ(json["wrong_merges"], ordered_json::parse(R"([["far", "right"]])"));
}

TEST(EvaluationJson, ChangesOfGroupsHaveTheirKindAndTime) {
  GroupScore score;
  TrueOverlap::Change change;
  change.t_ns = 5'000'000'000;
  change.from_ns = 4'500'000'000;
  change.merge = true;
  change.first = {"left"}, change.second = {"right"};
  score.changes = {{change, 0.25}, {change, std::nullopt}};
  score.false_changes = {{9'000'000'000, false, {"left"}, {"right"}}};
  Evaluation e;
  e.groups = score;
  const ordered_json json = to_json(e)["groups"];
  EXPECT_EQ(json["merges"], 2);
  EXPECT_EQ(json["merges_found"], 1);
  EXPECT_EQ(json["false_splits"], 1);
  EXPECT_EQ(json["worst_delay_s"], 0.25);
  EXPECT_TRUE(json["shortest_state_s"].is_null());
  EXPECT_EQ(json["changes"][0]["kind"], "merge");
  EXPECT_EQ(json["changes"][0]["from_s"], 4.5);
  EXPECT_TRUE(json["changes"][1]["delay_s"].is_null()) << "it was missed";
  EXPECT_EQ(json["false_changes"][0]["kind"], "split");
  EXPECT_EQ(json["false_changes"][0]["t_s"], 9.0);
}

TEST(EvaluationJson, PointsHaveNeesWhereTheirCovariancesSaySomething) {
  Evaluation e;
  e.points = PointAccuracy{.count = 20, .error_median_m = 0.01, .nees_median = 2, .without_truth = 3};
  EXPECT_TRUE(to_json(e)["nees"].is_null());
  EXPECT_EQ(to_json(e)["points"]["without_truth"], 3);
  e.points->nees_count = 18;
  EXPECT_EQ(to_json(e)["nees"]["count"], 18);
  EXPECT_EQ(to_json(e)["nees"]["median"], 2.0);
}

TEST(EvaluationJson, BodiesAreToldEachAndTogether) {
  Evaluation e;
  e.bodies["plate"] = {
      .instants = 10, .covered = 8, .object_instants = 4, .objects_found = 3, .velocity_errors_m_s = {0.1}};
  e.bodies["cart"] = {.instants = 10, .covered = 2};
  const ordered_json json = to_json(e);
  EXPECT_EQ(json["dynamic_coverage"], 0.5);
  EXPECT_EQ(json["object_found"], 0.75);
  EXPECT_EQ(json["object_velocity_error_m_s"], 0.1);
  EXPECT_EQ(json["bodies"]["cart"]["dynamic_coverage"], 0.2);
  EXPECT_TRUE(json["bodies"]["cart"]["object_found"].is_null());
}

TEST(EvaluationJson, FiguresOfTheWholeAreTaken) {
  Evaluation e;
  e.sequence = "walk";
  e.alignment.target_from_source = Similarity3{2, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()};
  e.problem = "none";
  e.relative_pose = RelativePoseError{1, 0.02, 0.3, 2.0, 55};
  e.classification = ClassificationScore{.precision = 0.9, .observations = 400};
  e.dynamic_error_m = ErrorSpread{0.01, 0.03, 20};
  const ordered_json json = to_json(e);
  EXPECT_EQ(json["scale"], 2.0);
  EXPECT_EQ(json["problem"], "none");
  EXPECT_EQ(json["relative_pose"]["translation_scaled_m"], 0.02);
  EXPECT_EQ(json["relative_pose"]["count"], 55);
  EXPECT_EQ(json["classification"]["precision"], 0.9);
  EXPECT_TRUE(json["classification"]["recall"].is_null());
  EXPECT_EQ(json["dynamic_error_m"]["p90"], 0.03);
}

}  // namespace
}  // namespace coslam::eval::evaluation_json_test
