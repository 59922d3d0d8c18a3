// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/groups.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "deploy/coslam/eval/evaluation.h"
#include "tests/support/temp_folder.h"

namespace coslam::eval::groups_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const AgentNames kA{"a"}, kB{"b"}, kC{"c"}, kAb{"a", "b"}, kAbc{"a", "b", "c"};

std::vector<std::string> texts(const std::vector<GroupChange>& changes) {
  std::vector<std::string> out;
  for (const GroupChange& c : changes) {
    std::string text;
    for (const auto& name : c.first) text += name;
    text += c.merge ? "+" : "|";
    for (const auto& name : c.second) text += name;
    out.push_back(text);
  }
  return out;
}

TEST(ChangesBetween, SplitsThenMerges) {
  EXPECT_THAT(texts(changes_between({kAbc}, {kAb, kC}, 0)), ElementsAre("ab|c"));
  EXPECT_THAT(texts(changes_between({kA, kB, kC}, {kAbc}, 0)), ElementsAre("a+b", "ab+c"));
  EXPECT_THAT(texts(changes_between({kAb, kC}, {kA, {"b", "c"}}, 0)), ElementsAre("a|b", "b+c"));
  EXPECT_TRUE(changes_between({kAb, kC}, {kC, kAb}, 0).empty());
}

TEST(ChangesBetween, WhoIsMissingIsAlone) {
  EXPECT_THAT(texts(changes_between({}, {kAb}, 0)), ElementsAre("a+b"));
  EXPECT_THAT(texts(changes_between({kAb}, {kA}, 0)), ElementsAre("a|b"));
  EXPECT_TRUE(changes_between({kA}, {kA, kB}, 0).empty());
}

// a and b see the same but for 10 to 20 s; a second before the split and before the merge the overlap is small. c sees
// the same as b all the time.
std::vector<OverlapRow> overlap_rows() {
  std::vector<OverlapRow> rows;
  for (int i = 0; i <= 300; ++i) {
    const double t_s = 0.1 * i;
    double share = 0.6;
    if (t_s > 8.95 && t_s < 20.95) share = 0.1;
    if (t_s > 9.95 && t_s < 19.95) share = 0.01;
    const TimeNs t_ns = to_ns(t_s);
    rows.insert(rows.end(), {{t_ns, "a", "b", share},
                             {t_ns, "b", "a", 0.8 * share},
                             {t_ns, "b", "c", 0.5},
                             {t_ns, "c", "b", 0.5},
                             {t_ns, "a", "c", 0},
                             {t_ns, "c", "a", 0}});
  }
  return rows;
}

TEST(TrueOverlap, ChangesWithHysteresisAndTheTimeInWhichEitherIsRight) {
  const auto changes = TrueOverlap(overlap_rows()).changes();
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_THAT(texts({changes[0], changes[1]}), ElementsAre("a|bc", "a+bc"));
  EXPECT_NEAR(to_seconds(changes[0].from_ns), 9, 0.01);
  EXPECT_NEAR(to_seconds(changes[0].t_ns), 10, 0.01);
  EXPECT_NEAR(to_seconds(changes[1].from_ns), 20, 0.01);
  EXPECT_NEAR(to_seconds(changes[1].t_ns), 21, 0.01);
}

ReportedGroups report(std::initializer_list<std::pair<double, Partition>> states) {
  ReportedGroups out;
  for (const auto& [t_s, partition] : states) out[to_ns(t_s)] = partition;
  return out;
}

TEST(ScoreGroups, ChangesInTimeHaveNoDelay) {
  const auto score =
      score_groups(report({{0.1, {kAbc}}, {9.5, {kA, {"b", "c"}}}, {20.9, {kAbc}}}), TrueOverlap(overlap_rows()));
  EXPECT_EQ(score.count(false), 1);
  EXPECT_EQ(score.found(false), 1);
  EXPECT_EQ(score.count(true), 1);
  EXPECT_EQ(score.found(true), 1);
  EXPECT_EQ(score.worst_delay_s(), 0);
  EXPECT_TRUE(score.false_changes.empty());
  EXPECT_NEAR(*score.shortest_state_s, 11.4, 1e-9);
}

TEST(ScoreGroups, LateEarlyAndMissed) {
  const auto score = score_groups(report({{0.1, {kAbc}}, {8.4, {kA, {"b", "c"}}}}), TrueOverlap(overlap_rows()));
  ASSERT_EQ(score.changes.size(), 2u);
  EXPECT_NEAR(*score.changes[0].delay_s, -0.6, 1e-6);
  EXPECT_FALSE(score.changes[1].delay_s);
  EXPECT_EQ(score.found(true), 0);
  const auto late = score_groups(report({{0.1, {kAbc}}, {11.5, {kA, {"b", "c"}}}}), TrueOverlap(overlap_rows()));
  EXPECT_NEAR(*late.worst_delay_s(), 1.5, 1e-6);
}

TEST(ScoreGroups, ChangesWithoutReasonAreFalse) {
  // b and c always see the same; a and b do not at 15 s.
  const auto score = score_groups(report({{0.1, {kAbc}},
                                          {5, {kAb, kC}},
                                          {5.2, {kAbc}},
                                          {10, {kA, {"b", "c"}}},
                                          {15, {kAbc}},
                                          {15.5, {kA, {"b", "c"}}}}),
                                  TrueOverlap(overlap_rows()));
  EXPECT_THAT(texts(score.false_changes), ElementsAre("ab|c", "a+bc"));
  EXPECT_NEAR(*score.shortest_state_s, 0.2, 1e-9);
}

TEST(MapsOf, WhoWasEverTogether) {
  const Partition maps = maps_of(report({{0, {kAb, kC, {"d"}}}, {5, {kA, kB, {"c", "d"}}}}));
  EXPECT_EQ(maps, (Partition{kAb, {"c", "d"}}));
}

TEST(ReadOverlap, NamesTheBadLine) {
  const test::TempFolder folder;
  const auto good = folder.write("good.csv", "t_s,agent_a,agent_b,share\n0.1,a,b,0.5\n");
  ASSERT_EQ(read_overlap(good).size(), 1u);
  EXPECT_EQ(read_overlap(good)[0].share, 0.5);
  const auto bad = folder.write("bad.csv", "t_s,agent_a,agent_b,share\n0.1,a,b,much\n");
  EXPECT_THAT(test::error_of<UserError>([&] { read_overlap(bad); }), HasSubstr("bad.csv:2"));
}

// An agent that goes back and forth over 10 m.
AgentPaths agent_path(const std::string& name, const Eigen::Vector3d& from, const Eigen::Vector3d& along,
                      const Eigen::Vector3d& estimated_from) {
  AgentPaths out;
  out.name = name;
  for (int i = 0; i <= 100; ++i) {
    const Eigen::Vector3d gone = 0.1 * i * along + std::sin(0.2 * i) * Eigen::Vector3d::UnitZ();
    out.truth.push_back({i * 100'000'000LL, Rigid3(Eigen::Quaterniond::Identity(), from + gone).inverse()});
    out.estimate.push_back(
        {i * 100'000'000LL, Rigid3(Eigen::Quaterniond::Identity(), estimated_from + gone).inverse()});
  }
  return out;
}

TEST(EvaluateMaps, AgentsThatDoNotFitTogetherAreAWrongMerge) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), origin(0, 0, 0), away(20, 0, 0);
  const std::vector<AgentPaths> agents{agent_path("a", origin, x, origin), agent_path("b", origin, y, origin),
                                       agent_path("c", away, y, origin)};
  Evaluation e;
  evaluate_maps(e, agents, {kAbc}, 10);
  EXPECT_THAT(e.wrong_merges, ElementsAre(std::pair<std::string, std::string>("a", "c"),
                                          std::pair<std::string, std::string>("b", "c")));
  Evaluation apart;
  evaluate_maps(apart, agents, {kAb, kC}, 10);
  EXPECT_TRUE(apart.wrong_merges.empty());
  ASSERT_EQ(apart.maps.size(), 2u);
  EXPECT_NEAR(*apart.maps[0].ate_m, 0, 1e-9);
  EXPECT_NEAR(*apart.maps[1].ate_m, 0, 1e-9);
}

}  // namespace
}  // namespace coslam::eval::groups_test
