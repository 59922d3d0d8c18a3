// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
// The scenes in which cameras part and meet.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "deploy/simulation/motion.h"
#include "deploy/simulation/simulated_scene.h"
#include "deploy/simulation/view_overlap.h"

namespace coslam::sim::groups_test {
namespace {

using Group = std::set<int>;
using Groups = std::set<Group>;
using ::testing::Contains;
using ::testing::ElementsAre;

// Components of the cameras of which each sees `least` or more of the other's view.
Groups groups_at(const ViewOverlap& overlap, double t_s, double least) {
  const Eigen::MatrixXd shares = overlap.at(t_s);
  std::vector<int> label;
  for (int i = 0; i < shares.rows(); ++i) label.push_back(i);
  for (int pass = 0; pass < shares.rows(); ++pass) {
    for (int a = 0; a < shares.rows(); ++a) {
      for (int b = 0; b < shares.rows(); ++b) {
        if (std::min(shares(a, b), shares(b, a)) < least) continue;
        auto &of_a = label[static_cast<std::size_t>(a)], &of_b = label[static_cast<std::size_t>(b)];
        of_a = of_b = std::min(of_a, of_b);
      }
    }
  }
  std::map<int, Group> by_label;
  for (std::size_t i = 0; i < label.size(); ++i) by_label[label[i]].insert(static_cast<int>(i));
  Groups out;
  for (const auto& [unused, group] : by_label) out.insert(group);
  return out;
}

constexpr double kSame = 0.15, kNothing = 0.02;

double path_m(const Scene& scene, int camera) {
  double sum_m = 0;
  for (int frame = 1; frame < scene.frames(); ++frame) {
    sum_m += (scene.cam_from_world(camera, frame / scene.rate_hz()).center() -
              scene.cam_from_world(camera, (frame - 1) / scene.rate_hz()).center())
                 .norm();
  }
  return sum_m;
}

double end_s(const Scene& scene) { return (scene.frames() - 1) / scene.rate_hz(); }

SceneDescription with_lenses(SceneDescription scene) {
  for (SceneCamera& camera : scene.cameras) camera.model = simulated_camera(0);
  return scene;
}

TEST(ViewOverlap, IsOneForTheSameViewAndFallsWithTheTurn) {
  class Turned : public SimulatedScene {
   public:
    using SimulatedScene::SimulatedScene;
    double turn_rad = 0;
    Rigid3 cam_from_world(int camera, double t_s) const override {
      const Rigid3 first = SimulatedScene::cam_from_world(0, t_s);
      return camera == 0 ? first : Rigid3(so3_exp({0, turn_rad, 0}), {0, 0, 0}) * first;
    }
  };
  Turned scene(with_lenses(describe_room(1, 2)), {});
  EXPECT_NEAR(ViewOverlap(scene).at(1)(0, 1), 1, 1e-9);
  EXPECT_NEAR(ViewOverlap(scene).at(1)(0, 0), 1, 1e-9);
  scene.turn_rad = 0.35;  // of a view of 1.35
  EXPECT_NEAR(ViewOverlap(scene).at(1)(0, 1), 0.75, 0.08);
  scene.turn_rad = 1.7;
  EXPECT_EQ(ViewOverlap(scene).at(1)(0, 1), 0);
}

TEST(ViewOverlap, FromTheOtherSideNothingLooksTheSame) {
  class Opposite : public SimulatedScene {
   public:
    using SimulatedScene::SimulatedScene;
    Rigid3 cam_from_world(int camera, double) const override {
      return sim::cam_from_world(camera == 0 ? ViewPose{{-2.5, -1.5, 1.5}, 55, 0, 0}
                                             : ViewPose{{2.5, -1.5, 1.5}, 125, 0, 0});
    }
  };
  const Opposite scene(with_lenses(describe_wall(1, 2)), {});  // both see the wall in the north, from 70 degrees apart
  EXPECT_LT(ViewOverlap(scene).at(0)(0, 1), 0.25);
}

TEST(CourtyardScene, EveryWayIs96MetresLongAndCloses) {
  const auto scene = make_scene("courtyard", 1);
  ASSERT_EQ(scene->cameras(), 4);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(path_m(*scene, i), 96, 1) << i;
    const Rigid3 start = scene->cam_from_world(i, 0), end = scene->cam_from_world(i, end_s(*scene));
    EXPECT_LT((start.center() - end.center()).norm(), 0.05) << i;
    EXPECT_LT(start.rotation.angularDistance(end.rotation), 0.05) << i;
  }
}

TEST(CourtyardScene, PartsTwiceInDifferentPairs) {
  const auto scene = make_scene("courtyard", 1);
  const ViewOverlap overlap(*scene);
  const Groups all{{0, 1, 2, 3}};
  for (const double t_s : {0.0, 10.0, 23.0, 35.0, 43.0, 55.0, end_s(*scene)}) {
    EXPECT_EQ(groups_at(overlap, t_s, kSame), all) << t_s;
  }
  for (const double t_s : {15.0, 17.0, 19.5}) {
    EXPECT_EQ(groups_at(overlap, t_s, kSame), (Groups{{0, 1}, {2, 3}})) << t_s;
    EXPECT_EQ(groups_at(overlap, t_s, kNothing), (Groups{{0, 1}, {2, 3}})) << t_s;
  }
  for (const double t_s : {47.0, 49.0, 50.5}) {
    EXPECT_EQ(groups_at(overlap, t_s, kSame), (Groups{{0, 2}, {1, 3}})) << t_s;
    EXPECT_EQ(groups_at(overlap, t_s, kNothing), (Groups{{0, 2}, {1, 3}})) << t_s;
  }
}

TEST(StrangersScene, MeetAfterEightSeconds) {
  const auto scene = make_scene("strangers", 1);
  const ViewOverlap overlap(*scene);
  for (double t_s = 0; t_s < 7.5; t_s += 0.5) {
    EXPECT_EQ(groups_at(overlap, t_s, kSame), (Groups{{0, 1}, {2}})) << t_s;
    EXPECT_EQ(groups_at(overlap, t_s, kNothing), (Groups{{0, 1}, {2}})) << t_s;
  }
  for (double t_s = 10; t_s < end_s(*scene); t_s += 0.5) {
    EXPECT_EQ(groups_at(overlap, t_s, kSame), (Groups{{0, 1, 2}})) << t_s;
  }
}

TEST(TwinsScene, NeverSeeTheSame) {
  const auto scene = make_scene("twins", 1);
  const ViewOverlap overlap(*scene);
  for (double t_s = 0; t_s < end_s(*scene); t_s += 0.5) {
    EXPECT_EQ(overlap.at(t_s)(0, 1), 0) << t_s;
    EXPECT_EQ(overlap.at(t_s)(1, 0), 0) << t_s;
  }
}

TEST(TwinsScene, BothRoomsHaveTheSamePrintsInOtherPlaces) {
  const auto scene = make_simulated_scene("twins", 1, {});
  std::map<std::uint32_t, std::vector<Eigen::Vector3d>> places;  // in their room
  for (const Facet& f : scene->world().facets) {
    const bool print = f.material.kind == MaterialKind::kPoster || f.material.kind == MaterialKind::kPicture;
    if (print && f.width_m() > 0.4)
      places[f.material.seed].push_back(f.origin - Eigen::Vector3d(f.origin.x() > 10 ? 20 : 0, 0, 0));
  }
  int twice = 0;
  for (const auto& [seed, where] : places) {
    if (where.size() != 2) continue;
    ++twice;
    EXPECT_GT((where[0] - where[1]).norm(), 0.5) << seed;
  }
  EXPECT_EQ(twice, 8);
}

TEST(SwarmScene, TroopsPartThreeTimesAndMeetThreeTimes) {
  const auto scene = make_scene("swarm", 1);
  ASSERT_EQ(scene->cameras(), 12);
  EXPECT_EQ(scene->camera(0).width_px, 512);
  const ViewOverlap overlap(*scene);
  const Groups all{{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}}, troops{{0, 1, 2, 3, 4, 5}, {6, 7, 8, 9, 10, 11}};
  const Groups halves{{0, 2, 4}, {1, 3, 5}, {6, 8, 10}, {7, 9, 11}};
  const std::pair<double, Groups> expected[] = {{0, all},     {1.5, all},          {4.5, troops}, {8, troops},
                                                {11, halves}, {14.5, halves},      {19, troops},  {24, troops},
                                                {27.5, all},  {end_s(*scene), all}};
  for (const auto& [t_s, groups] : expected) EXPECT_EQ(groups_at(overlap, t_s, kSame), groups) << t_s;
}

}  // namespace
}  // namespace coslam::sim::groups_test
