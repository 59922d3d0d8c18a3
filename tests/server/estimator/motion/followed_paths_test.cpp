// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/followed_paths.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "server/estimator/motion/follow.h"
#include "tests/support/sim_map.h"

namespace coslam::followed_paths_test {
namespace {

using test::kPeriodNs;

// A body whose points two cameras have followed for 20 sets when they become moving points.
class FollowedPathsTest : public testing::Test {
 protected:
  FollowedPathsTest() : sim_(world_, test::paths_side_by_side(2), {.max_tracks = 400}) {
    sim_.advance(kSets);
    for (int i = kStatic; i < world_.size(); ++i) {
      if (!sim_.all_follow(i)) continue;
      const MapPoint& p = sim_.add_point(i, 0.02, Eigen::Vector3d::Zero(), PointPhase::kMoving);
      record_past(sim_.edit, p, kSets);
      sim_.record_now(p);
    }
  }
  void SetUp() override { ASSERT_EQ(sim_.map.moving_points().size(), 25U); }
  void step() {
    sim_.advance();
    follow_moving(sim_.edit, sim_.set, {});
    paths_.update(sim_.map, sim_.set.t_ns - kSpanNs);
  }
  void update() { paths_.update(sim_.map, sim_.set.t_ns - kSpanNs); }
  // Of every sample from where it truly was then, as the map has it.
  std::vector<double> errors_m(const Similarity3& map_from_world = {}) const {
    std::vector<double> out;
    for (const auto& [id, path] : paths_.all()) {
      const int point = sim_.world_point(*sim_.map.find(id));
      for (const PathSample& s : path.samples) {
        out.push_back((s.position - map_from_world * world_.position(point, s.t_ns)).norm() / map_from_world.scale);
      }
    }
    return out;
  }
  // All samples of all points.
  std::vector<Eigen::Vector3d> positions() const {
    std::vector<Eigen::Vector3d> out;
    for (const auto& [id, path] : paths_.all()) {
      for (const PathSample& s : path.samples) out.push_back(s.position);
    }
    return out;
  }
  void expect_moved(const std::vector<Eigen::Vector3d>& before, const Similarity3& by) const {
    const std::vector<Eigen::Vector3d> after = positions();
    ASSERT_EQ(after.size(), before.size());
    for (std::size_t i = 0; i < after.size(); ++i) EXPECT_LT((after[i] - by * before[i]).norm(), 1e-9);
  }

  static constexpr int kStatic = 300, kSets = 20;
  static constexpr TimeNs kSpanNs = 30 * kPeriodNs;
  const Similarity3 move_{2, Eigen::Quaterniond(Eigen::AngleAxisd(1, Eigen::Vector3d::UnitY())), {1, 2, 3}};
  const test::SimWorld world_{{.seed = 24, .points = kStatic, .moving_points = 25}};
  test::SimMap sim_;
  FollowedPaths paths_;
};

TEST_F(FollowedPathsTest, ANewPointHasThePathThatWasRecorded) {
  update();
  ASSERT_EQ(paths_.all().size(), 25U);
  for (const auto& [id, path] : paths_.all()) {
    EXPECT_EQ(path.samples.size(), static_cast<std::size_t>(kSets));
    EXPECT_EQ(path.anchors.size(), path.samples.size());
    EXPECT_EQ(path.samples.front().set, SetId(0));
    EXPECT_EQ(path.samples.back().set, sim_.set.id);
  }
  EXPECT_LT(test::median(errors_m()), 0.05);
}

TEST_F(FollowedPathsTest, AndGoesOnWithWhatIsRecorded) {
  update();
  for (int i = 1; i <= 20; ++i) {
    step();
    for (const auto& [id, path] : paths_.all()) {
      EXPECT_EQ(path.samples.back().set, sim_.set.id);
      EXPECT_EQ(path.samples.size(), static_cast<std::size_t>(std::min(kSets + i, 31))) << "of the span alone";
      EXPECT_GE(path.samples.front().t_ns, sim_.set.t_ns - kSpanNs);
      EXPECT_EQ(path.samples.back().position, sim_.map.find(id)->position);
    }
  }
  EXPECT_LT(test::median(errors_m()), 0.05);
}

TEST_F(FollowedPathsTest, FollowsItsMapWhenThatIsMoved) {
  update();
  const std::vector<Eigen::Vector3d> before = positions();
  sim_.edit.transform(sim_.id, move_, Why::kScaleKnown);
  update();
  expect_moved(before, move_);
}

TEST_F(FollowedPathsTest, FollowsItsMapIntoAnother) {
  update();
  const std::vector<Eigen::Vector3d> before = positions();
  const MapId other = sim_.edit.new_map(Why::kStartedAlone, 1);
  sim_.edit.merge(sim_.id, other, move_);
  update();
  expect_moved(before, move_);
  EXPECT_LT(test::median(errors_m(move_)), 0.05);
}

TEST_F(FollowedPathsTest, FollowsThePosesThatSawIt) {
  update();
  const std::vector<Eigen::Vector3d> before = positions();
  const Similarity3 move{1, Eigen::Quaterniond::Identity(), {0.3, 0, -0.2}};
  for (const MapCamera& c : sim_.map.cameras()) {
    for (const FramePose& f : c.frames) sim_.edit.adjust_pose(c, f, transform_world(f.cam_from_world, move));
  }
  update();
  EXPECT_EQ(positions(), before) << "nobody said that the map moved";
  sim_.edit.raise_epoch();
  update();
  expect_moved(before, move);
}

TEST_F(FollowedPathsTest, SamplesOfCamerasThatLeftAreDropped) {
  update();
  const SetId left(5);
  const MapId other = sim_.edit.new_map(Why::kStartedAlone, 1);
  const MapCamera& c = sim_.map.camera(CameraId(1));
  sim_.edit.place(c, left, other, c.frame_at(left)->cam_from_world, Why::kPlaceRecognised);
  sim_.edit.place(c, sim_.set.id, sim_.id, c.frames.back().cam_from_world, Why::kPlaceRecognised);
  sim_.edit.raise_epoch();
  update();
  for (const auto& [id, path] : paths_.all()) {
    EXPECT_EQ(path.samples.size(), kSets - 1U);
    for (const PathSample& s : path.samples) EXPECT_NE(s.set, left);
  }
}

TEST_F(FollowedPathsTest, WhatStopsOrIsGoneHasNone) {
  update();
  const MapPoint& stopped = *sim_.map.moving_points()[0];
  const PointId gone = sim_.map.moving_points()[1]->id;
  sim_.edit.stop_moving(stopped, 6);
  sim_.edit.remove_point(*sim_.map.find(gone), Why::kOutOfSight);
  update();
  EXPECT_FALSE(paths_.all().contains(stopped.id));
  EXPECT_FALSE(paths_.all().contains(gone));
  EXPECT_EQ(paths_.all().size(), 23U);
}

}  // namespace
}  // namespace coslam::followed_paths_test
