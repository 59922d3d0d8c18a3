// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/covisibility/grouping.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/support/sim_map.h"

namespace coslam::grouping_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

CameraId cam(int i) { return CameraId(static_cast<std::uint16_t>(i)); }

// Cameras that all look at the same; the test says which share map points.
class GroupTest : public testing::Test {
 protected:
  GroupTest() : sim_(world_, std::vector<test::CameraPath>(5, test::still_path(test::looking({0, 0, 0})))) {
    sim_.advance();
  }
  // `count` new points that exactly these cameras see.
  void share(std::initializer_list<int> cameras, int count) {
    for (int i = 0; i < count; ++i) {
      while (sim_.track_of(cam(0), next_) == nullptr) ++next_;
      const MapPoint& p = sim_.create(world_.position(next_), 1);
      for (const int c : cameras) sim_.bind(p, cam(c), *sim_.track_of(cam(c), next_));
      ++next_;
    }
  }
  ViewGraph graph() const { return view_graph(sim_.map, sim_.set); }
  static int shared(const std::vector<ViewEdge>& edges, int a, int b) {
    for (const ViewEdge& e : edges) {
      if (e.first == cam(a) && e.second == cam(b)) return e.shared;
    }
    return 0;
  }

  const test::SimWorld world_{{}};
  test::SimMap sim_;
  int next_ = 0;
};

TEST_F(GroupTest, EdgesCountSharedPoints) {
  share({0, 1}, 7);
  share({1, 0, 2}, 3);
  share({3}, 4);
  const ViewGraph g = graph();
  EXPECT_EQ(shared(g.edges, 0, 1), 10);
  EXPECT_EQ(shared(g.edges, 0, 2), 3);
  EXPECT_EQ(shared(g.edges, 1, 2), 3);
  EXPECT_EQ(g.edges.size(), 3U);
}

TEST_F(GroupTest, TheTreeHasTheHeaviestEdges) {
  share({0, 1}, 5);
  share({1, 2}, 9);
  share({0, 2}, 7);
  share({2, 3}, 1);
  share({1, 3}, 2);
  const ViewGraph g = graph();
  EXPECT_EQ(g.edges.size(), 5U);
  ASSERT_EQ(g.tree.size(), 3U);
  EXPECT_EQ(shared(g.tree, 1, 2), 9);
  EXPECT_EQ(shared(g.tree, 0, 2), 7);
  EXPECT_EQ(shared(g.tree, 1, 3), 2);
}

TEST_F(GroupTest, GroupsAreConnectedComponents) {
  share({0, 3}, 2);
  share({2, 4}, 2);
  EXPECT_THAT(graph().groups,
              ElementsAre(ElementsAre(cam(0), cam(3)), ElementsAre(cam(1)), ElementsAre(cam(2), cam(4))));
  share({3, 4}, 1);
  EXPECT_THAT(graph().groups, ElementsAre(ElementsAre(cam(0), cam(2), cam(3), cam(4)), ElementsAre(cam(1))));
}

TEST_F(GroupTest, ACameraWithoutAMapIsInNoGroup) {
  share({0, 1}, 2);
  sim_.edit.leave_map(sim_.map.camera(cam(2)));
  for (const auto& group : graph().groups) EXPECT_EQ(std::count(group.begin(), group.end(), cam(2)), 0);
}

TEST_F(GroupTest, NoPointsNoEdges) {
  const ViewGraph g = graph();
  EXPECT_THAT(g.edges, IsEmpty());
  EXPECT_THAT(g.tree, IsEmpty());
  EXPECT_EQ(g.groups.size(), 5U);
}

TEST_F(GroupTest, TheTreeSpansEveryGroupOfARealView) {
  test::SimMap sim(world_, test::paths_side_by_side(4));
  sim.advance();
  sim.add_points();
  const ViewGraph g = view_graph(sim.map, sim.set);
  EXPECT_EQ(g.groups.size(), 1U);
  EXPECT_EQ(g.tree.size(), 3U);
  std::set<CameraId> reached;
  for (const ViewEdge& e : g.tree) {
    EXPECT_LT(e.first, e.second);
    reached.insert({e.first, e.second});
  }
  EXPECT_EQ(reached.size(), 4U);
}

// Cameras 0 and 1 share what the test says, 30 sets a second.
class GroupingTest : public GroupTest {
 protected:
  // So many shared points for some sets; when the two became (or ceased to be) one group, in sets from 0, else -1.
  int run(int shared, int sets) {
    while (!made_.empty()) {
      sim_.edit.remove_point(*sim_.map.find(made_.back()), Why::kUndetermined);
      made_.pop_back();
    }
    int when = -1;
    for (int i = 0; i < sets; ++i) {
      sim_.advance();
      for (int p = 0; static_cast<int>(made_.size()) < shared; ++p) {
        if (sim_.track_of(cam(0), p) == nullptr || sim_.track_of(cam(1), p) == nullptr) continue;
        const MapPoint& made = sim_.create(world_.position(p), 1);
        for (const int c : {0, 1}) sim_.bind(made, cam(c), *sim_.track_of(cam(c), p));
        made_.push_back(made.id);
      }
      const bool now = grouping_.run(sim_.map, sim_.set).groups[0].size() == 2;
      if (now != together_) when = i;
      together_ = now;
    }
    return when;
  }
  Grouping grouping_{GroupingConfig{}};
  std::vector<PointId> made_;
  bool together_ = false;
};

TEST_F(GroupingTest, JoinsAndPartsWithinASecond) {
  EXPECT_EQ(run(0, 40), -1);
  const int joined = run(20, 40);
  EXPECT_GT(joined, 2);
  EXPECT_LT(joined, 20);
  EXPECT_EQ(run(6, 60), -1) << "fewer points keep them together";
  const int parted = run(0, 60);
  EXPECT_GT(parted, 10);
  EXPECT_LT(parted, 30);
}

TEST_F(GroupingTest, DoesNotFlicker) {
  run(20, 60);
  ASSERT_TRUE(together_);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(run(i % 2 == 0 ? 0 : 20, 10), -1) << "a third of a second";
  int changes = 0;
  for (int i = 0; i < 10; ++i) changes += run(i % 2 == 0 ? 0 : 20, 17) >= 0;
  EXPECT_LE(changes, 6) << "5.7 s in all, none shorter than one";
}

// Three frames of the first camera to one of the second, never in one set.
TEST_F(GroupingTest, CamerasOfOtherRatesAndMomentsAreTogetherAllTheSame) {
  for (int p = 0, made = 0; made < 40; ++p) {
    if (sim_.track_of(cam(0), p) == nullptr || sim_.track_of(cam(1), p) == nullptr) continue;
    const MapPoint& point = sim_.create(world_.position(p), 1);
    for (const int c : {0, 1}) sim_.bind(point, cam(c), *sim_.track_of(cam(c), p));
    ++made;
  }
  const auto together_after = [&](int sets) {
    bool together = false;
    for (int i = 0; i < sets; ++i) {
      FrameSet& set = sim_.look();
      const CameraId left_out = cam(i % 3 == 0 ? 0 : 1);
      std::erase_if(set.frames, [&](const CameraFrame& f) { return f.camera == left_out; });
      sim_.take();
      sim_.place_truly();
      const ViewGraph graph = grouping_.run(sim_.map, sim_.set);
      EXPECT_TRUE(std::ranges::none_of(graph.edges,
                                       [&](const ViewEdge& e) { return e.first == cam(0) && e.second == cam(1); }));
      together = graph.group_of(cam(0)) == graph.group_of(cam(1));
    }
    return together;
  };
  EXPECT_TRUE(together_after(40));
  EXPECT_TRUE(together_after(60)) << "and stay so";
}

// Cameras 0 and 1 look at the same, but their points are not the same ones, or few are.
class OverlappingGroupTest : public GroupTest {
 protected:
  void see_apart() {
    for (const int c : {0, 1}) {
      for (const auto& [id, t] : sim_.map.camera(cam(c)).tracks) {
        if (t.bound()) continue;
        sim_.bind(sim_.create(world_.position(sim_.world_point(cam(c), id))), cam(c), t);
      }
    }
  }
  bool together_after(int sets) {
    bool together = false;
    for (int i = 0; i < sets; ++i) {
      sim_.advance();
      together = grouping_.run(sim_.map, sim_.set).groups[0].size() == 2;
    }
    return together;
  }
  Grouping grouping_{GroupingConfig{}};
};

TEST_F(OverlappingGroupTest, FewSharedPointsConfirmAnOverlap) {
  share({0, 1}, 11);
  see_apart();
  EXPECT_TRUE(together_after(40));
}

TEST_F(OverlappingGroupTest, TheWiderItIsTheFewerDo) {
  share({0, 1}, 3);
  see_apart();
  EXPECT_TRUE(together_after(40));
}

TEST_F(OverlappingGroupTest, AnOverlapAloneDoesNotJoin) {
  see_apart();
  EXPECT_FALSE(together_after(40));
}

TEST_F(OverlappingGroupTest, AnOverlapKeepsThem) {
  share({0, 1}, 20);
  ASSERT_TRUE(together_after(40));
  std::vector<PointId> shared;
  for (const auto& [id, p] : sim_.map.points()) shared.push_back(id);
  for (const PointId id : shared) sim_.edit.remove_point(*sim_.map.find(id), Why::kUndetermined);
  see_apart();
  EXPECT_TRUE(together_after(60));
}

}  // namespace
}  // namespace coslam::grouping_test
