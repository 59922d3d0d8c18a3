// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/bundle_structure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "tests/support/sim_world.h"

namespace coslam::bundle_structure_test {
namespace {

// Problems at random: who sees what, what is fixed, tied, breathes or has a lens. Positions do not matter.
class Structures {
 public:
  explicit Structures(unsigned seed) : random_(seed) {
    const std::size_t cameras = 1 + below(3), poses = 3 + below(18), points = 2 + below(20);
    problem.cameras.assign(cameras, test::sim_camera());
    problem.points.resize(points);
    for (std::size_t i = 0; i < poses; ++i) {
      problem.poses.push_back({{}, static_cast<int>(below(cameras)), chance() < 0.3});
    }
    if (chance() < 0.7) add_lenses();
    if (!problem.lenses.empty() && chance() < 0.7) add_zooms();
    for (std::size_t p = 0; p < points; ++p) {
      if (chance() < 0.1) continue;  // seen by nobody
      for (std::size_t i = 0; i < poses; ++i) {
        if (chance() > 0.3) continue;
        see(i, p);
        if (chance() < 0.1) see(i, p);  // by two tracks of one image
      }
    }
    std::ranges::shuffle(problem.observations, random_);
    for (std::size_t left = below(4); left > 0; --left) {
      problem.ties.push_back({static_cast<int>(below(poses)), static_cast<int>(below(poses)), {}});
    }
  }

  // Columns that an observation depends on.
  static std::set<int> columns_of(const BundleProblem& problem, const BundleStructure& s,
                                  const BundleProblem::Observation& o) {
    std::set<int> out;
    if (s.column_of[at(o.pose)] >= 0) out.insert(s.column_of[at(o.pose)]);
    const int lens = s.lens_column_of[at(problem.poses[at(o.pose)].camera)];
    for (int half = 0; lens >= 0 && half < BundleStructure::kHalves; ++half) out.insert(lens + half);
    if (s.zoom_of[at(o.pose)].column >= 0) out.insert(s.zoom_of[at(o.pose)].column);
    return out;
  }

  BundleProblem problem;

 private:
  double chance() { return std::uniform_real_distribution<>(0, 1)(random_); }
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_); }
  void add_lenses() {
    problem.lenses.resize(problem.cameras.size());
    for (BundleProblem::Lens& lens : problem.lenses) lens.free = chance() < 0.7;
  }
  void add_zooms() {
    problem.zooms.resize(problem.poses.size());
    std::vector<int> last(problem.cameras.size(), -1);
    for (std::size_t i = 0; i < problem.poses.size(); ++i) {
      if (chance() < 0.2) continue;
      int& before = last[at(problem.poses[i].camera)];
      problem.zooms[i] = BundleProblem::Zoom{.before = std::exchange(before, static_cast<int>(i))};
    }
  }
  void see(std::size_t pose, std::size_t point) {
    problem.observations.push_back({static_cast<int>(pose), static_cast<int>(point), {320, 240}, 0.5});
  }
  std::mt19937_64 random_;
};

class BundleStructureTest : public testing::TestWithParam<unsigned> {
 protected:
  const Structures made_{GetParam()};
  const BundleProblem& problem_ = made_.problem;
  const BundleStructure s_ = structure_of(problem_);
};
INSTANTIATE_TEST_SUITE_P(Seeds, BundleStructureTest, testing::Range(1U, 17U));

TEST_P(BundleStructureTest, EachColumnStandsForOneThing) {
  std::multiset<int> columns;
  for (std::size_t i = 0; i < problem_.poses.size(); ++i) {
    EXPECT_EQ(s_.column_of[i] < 0, problem_.poses[i].fixed);
    if (s_.column_of[i] >= 0) columns.insert(s_.column_of[i]);
  }
  for (std::size_t c = 0; c < problem_.cameras.size(); ++c) {
    const bool is_free = !problem_.lenses.empty() && problem_.lenses[c].free;
    EXPECT_EQ(s_.lens_column_of[c] >= 0, is_free);
    for (int half = 0; is_free && half < BundleStructure::kHalves; ++half) columns.insert(s_.lens_column_of[c] + half);
  }
  std::map<int, std::set<int>> slots;  // by column of zooms
  for (std::size_t i = 0; i < s_.zoom_of.size(); ++i) {
    const auto [column, slot] = s_.zoom_of[i];
    EXPECT_EQ(column >= 0, !problem_.zooms.empty() && problem_.zooms[i].has_value());
    if (column < 0) continue;
    EXPECT_TRUE(slots[column].insert(slot).second) << "a place for each zoom";
    EXPECT_TRUE(slot >= 0 && slot < BundleStructure::kZooms);
    for (std::size_t k = 0; k < i; ++k) {
      const bool shared = s_.zoom_of[k].column == column;
      EXPECT_TRUE(!shared || problem_.poses[k].camera == problem_.poses[i].camera);
    }
  }
  for (const auto& [column, used] : slots) columns.insert(column);
  ASSERT_EQ(columns.size(), static_cast<std::size_t>(s_.columns));
  int expected = 0;
  for (const int column : columns) EXPECT_EQ(column, expected++);
}

TEST_P(BundleStructureTest, LinksAreThePairsOfPointsAndColumnsThatMeet) {
  std::set<std::pair<int, int>> expected;  // point, column
  for (const auto& o : problem_.observations) {
    for (const int column : Structures::columns_of(problem_, s_, o)) expected.emplace(o.point, column);
  }
  std::vector<std::pair<int, int>> links;
  for (const BundleStructure::Link& l : s_.links) links.emplace_back(l.point, l.column);
  EXPECT_EQ(links, std::vector(expected.begin(), expected.end())) << "sorted, each once";
  ASSERT_EQ(s_.links_end.size(), problem_.points.size());
  for (std::size_t p = 0; p < problem_.points.size(); ++p) {
    const auto end = std::ranges::count_if(links, [&](const auto& l) { return l.first <= static_cast<int>(p); });
    EXPECT_EQ(s_.links_end[p], end);
  }
}

TEST_P(BundleStructureTest, EachObservationKnowsItsLinks) {
  const auto expect_link = [&](int link, int point, int column) {
    if (column < 0) {
      EXPECT_EQ(link, -1);
      return;
    }
    ASSERT_TRUE(link >= 0 && at(link) < s_.links.size());
    EXPECT_EQ(s_.links[at(link)].point, point);
    EXPECT_EQ(s_.links[at(link)].column, column);
  };
  for (std::size_t i = 0; i < problem_.observations.size(); ++i) {
    const auto& o = problem_.observations[i];
    expect_link(s_.link_of[i], o.point, s_.column_of[at(o.pose)]);
    expect_link(s_.zoom_link_of[i], o.point, s_.zoom_of[at(o.pose)].column);
    const int lens = s_.lens_column_of[at(problem_.poses[at(o.pose)].camera)];
    for (int half = 0; half < BundleStructure::kHalves; ++half) {
      expect_link(s_.lens_link_of[at(half)][i], o.point, lens < 0 ? -1 : lens + half);
    }
  }
}

TEST_P(BundleStructureTest, BlocksAreNotEmptyWhereSomethingDependsOnBothColumns) {
  std::vector<std::set<int>> rows(at(s_.columns));
  const auto meet = [&](int a, int b) {
    if (a >= 0 && b >= 0) rows[at(std::min(a, b))].insert(std::max(a, b));
  };
  for (int c = 0; c < s_.columns; ++c) meet(c, c);
  for (const auto& o : problem_.observations) {
    for (const auto& q : problem_.observations) {
      if (o.point != q.point) continue;
      for (const int a : Structures::columns_of(problem_, s_, o)) {
        for (const int b : Structures::columns_of(problem_, s_, q)) meet(a, b);
      }
    }
  }
  for (const auto& t : problem_.ties) meet(s_.column_of[at(t.first)], s_.column_of[at(t.second)]);
  for (std::size_t i = 0; i < problem_.zooms.size(); ++i) {
    if (problem_.zooms[i] && problem_.zooms[i]->before >= 0)
      meet(s_.zoom_of[i].column, s_.zoom_of[at(problem_.zooms[i]->before)].column);
  }
  ASSERT_EQ(s_.rows_at.size(), rows.size());
  for (std::size_t c = 0; c < rows.size(); ++c) {
    EXPECT_EQ(s_.rows_at[c], std::vector(rows[c].begin(), rows[c].end())) << c;
  }
}

TEST_P(BundleStructureTest, ObservationsAreWhitenedOnceWhereNoLensChanges) {
  const std::size_t n = problem_.observations.size();
  EXPECT_EQ(s_.whiten.size(), problem_.lenses.empty() ? n : 0);
  EXPECT_EQ(s_.raw_px.size(), problem_.lenses.empty() ? 0 : n);
  for (const Eigen::Matrix2d& w : s_.whiten) EXPECT_NEAR(w(0, 0), 2, 1e-9) << "one over the standard deviation";
}

TEST(BundleStructureEmpty, NothingToSolveHasNoColumns) {
  const BundleStructure none = structure_of({});
  EXPECT_EQ(none.columns, 0);
  EXPECT_TRUE(none.links.empty());
  BundleProblem fixed;
  fixed.cameras = {test::sim_camera()};
  fixed.poses = {{{}, 0, true}};
  fixed.points.resize(1);
  fixed.observations.push_back({0, 0, {320, 240}});
  const BundleStructure s = structure_of(fixed);
  EXPECT_EQ(s.columns, 0);
  EXPECT_EQ(s.link_of, std::vector{-1});
  EXPECT_EQ(s.links_end, std::vector{0});
}

}  // namespace
}  // namespace coslam::bundle_structure_test
