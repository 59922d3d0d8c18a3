// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/import_pen.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "tests/support/map_checks.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

// Maps of one server beside those of another. That places common to both join them is in map_server_merge_test.cpp.
namespace coslam::import_pen_test {
namespace {

using test::PoseNear;

constexpr CameraId kCam0(0), kCam1(1);

class TakenInTest : public testing::Test {
 protected:
  TakenInTest() {
    for (test::SimMap* sim : {&here_, &there_}) {
      sim->advance(6);
      sim->add_points();
      sim->edit.add_key_frame(SetId(1));
      sim->edit.add_key_frame(SetId(3), {kCam1});
      sim->advance(2);
    }
    there_.edit.add_key_image(there_.set.id, kCam0);
    const MapPoint& moving = there_.create({0, 0, 5}, 0.01, PointPhase::kMoving);
    moving_ = moving.id;
    there_.edit.record_motion(moving_, {SetId(7), there_.set.t_ns, {{kCam1, {3, 4}}}});
    there_.edit.transform(there_.id, {1.5, Eigen::Quaterniond::Identity(), {1, 0, 0}}, Why::kScaleKnown);
    there_.edit.set_metric(there_.id);
  }
  std::size_t points_here() const { return here_.map.points().size(); }

  const test::SimWorld world_{{.points = 60}}, elsewhere_{{.seed = 2, .points = 60}};
  test::SimMap here_{world_, test::paths_side_by_side(2)}, there_{elsewhere_, test::paths_side_by_side(2)};
  PointId moving_;  // a point there
};

TEST_F(TakenInTest, CamerasAreNewOnesThatSeeNothingAnyMore) {
  here_.edit.take_in(there_.map);
  ASSERT_EQ(here_.map.cameras().size(), 4U);
  for (const std::uint16_t i : {0U, 1U}) {
    const MapCamera &before = there_.map.camera(CameraId(i)),
                    &now = here_.map.camera(CameraId(static_cast<std::uint16_t>(2 + i)));
    EXPECT_EQ(now.id, CameraId(static_cast<std::uint16_t>(2 + i)));
    EXPECT_EQ(now.name, before.name + "-2");
    EXPECT_EQ(now.model, before.model);
    EXPECT_FALSE(now.alive);
    EXPECT_EQ(now.run, RunId());
    EXPECT_EQ(now.map, MapId());
    EXPECT_TRUE(now.tracks.empty());
    ASSERT_EQ(now.frames.size(), before.frames.size());
    EXPECT_THAT(now.frames.back().cam_from_world, PoseNear(before.frames.back().cam_from_world, 1e-12, 1e-12));
  }
  test::expect_consistent(here_.map);
}

TEST_F(TakenInTest, EverythingHasANewNumberAndComesLater) {
  const TimeNs now_ns = here_.map.now_ns();
  const SetId now = here_.map.now();
  const MapId next = here_.map.next_map();
  const std::size_t before = points_here();
  const Renumbered as = here_.edit.take_in(there_.map);
  EXPECT_EQ(as.new_id(there_.id), next);
  EXPECT_TRUE(here_.map.is_metric(next));
  EXPECT_FALSE(here_.map.is_metric(here_.id));
  const MapCamera& first = here_.map.camera(as.new_id(kCam0));
  EXPECT_EQ(first.frames.front().capture_ns, now_ns + 1'000'000'000) << "a second after the newest that was here";
  EXPECT_GT(first.frames.front().set, now);
  EXPECT_EQ(first.frames.back().map, next);
  EXPECT_EQ(here_.map.now(), first.frames.back().set);
  EXPECT_EQ(here_.map.now_ns(), first.frames.back().capture_ns);
  EXPECT_EQ(points_here(), before + there_.map.points().size() - 1) << "but for the one that moves";
  for (const auto& [id, p] : there_.map.points()) {
    const MapPoint* same = here_.map.find(as.new_id(id));
    if (id == moving_) {
      EXPECT_EQ(same, nullptr) << "nobody sees where it is by now";
      continue;
    }
    ASSERT_NE(same, nullptr);
    EXPECT_EQ(same->map, next);
    EXPECT_EQ(same->position, p.position);
    EXPECT_EQ(same->first_ns, p.first_ns + as.later_ns);
    ASSERT_EQ(same->key_observations.size(), p.key_observations.size());
    for (std::size_t i = 0; i < p.key_observations.size(); ++i) {
      EXPECT_EQ(same->key_observations[i].camera, as.new_id(p.key_observations[i].camera));
      EXPECT_EQ(same->key_observations[i].set, as.new_id(p.key_observations[i].set));
    }
  }
}

TEST_F(TakenInTest, KeyFramesMovesAndPathsComeAlong) {
  const std::size_t frames = here_.map.key_frames().size(), moves = here_.map.moves().size();
  const Renumbered as = here_.edit.take_in(there_.map);
  EXPECT_EQ(here_.map.key_frames().size(), 2 * frames);
  EXPECT_TRUE(here_.map.is_key_frame(as.new_id(SetId(3))));
  EXPECT_TRUE(std::ranges::is_sorted(here_.map.key_frames(), {}, &KeyFrame::set));
  EXPECT_TRUE(here_.map.skipped_key_images().contains({as.new_id(SetId(3)), as.new_id(kCam1)}));
  EXPECT_TRUE(here_.map.key_images().contains({as.new_id(SetId(7)), as.new_id(kCam0)}));
  ASSERT_EQ(here_.map.moves().size(), moves + 1);
  EXPECT_EQ(here_.map.moves().back().from, as.new_id(there_.id));
  ASSERT_TRUE(here_.map.motions().contains(as.new_id(moving_)));
  const MotionSample& sample = here_.map.motions().at(as.new_id(moving_)).front();
  EXPECT_EQ(sample.set, as.new_id(SetId(7)));
  EXPECT_EQ(sample.t_ns, there_.set.t_ns + as.later_ns);
  EXPECT_EQ(sample.seen.front().camera, as.new_id(kCam1));
}

TEST_F(TakenInTest, WhatIsMadeAfterwardsHasANumberOfItsOwn) {
  here_.edit.take_in(there_.map);
  std::set<PointId> taken;
  for (const auto& [id, p] : here_.map.points()) taken.insert(id);
  EXPECT_FALSE(taken.contains(here_.create({0, 0, 5}).id));
  const MapId made = here_.edit.new_map(Why::kStartedAlone, 1);
  for (const MapCamera& c : here_.map.cameras()) EXPECT_EQ(c.frames_in_map(made), 0);
}

TEST_F(TakenInTest, ANameThatIsTakenGetsAMarkWithinItsLength) {
  const std::string name(32, 'x');
  for (test::SimMap* sim : {&here_, &there_}) sim->edit.add_camera(name, RunId(7), test::sim_camera());
  here_.edit.take_in(there_.map);
  EXPECT_EQ(here_.map.cameras().back().name, std::string(30, 'x') + "-2");
  here_.edit.take_in(there_.map);
  EXPECT_EQ(here_.map.cameras().back().name, std::string(30, 'x') + "-3");
}

TEST_F(TakenInTest, WhatLeftItsMemoryIsWithinTheTimeToo) {
  const MapCamera& camera = there_.map.camera(kCam0);
  there_.edit.take_frames(camera, SetId(4), {});
  const int placed = camera.frames_in_map(there_.id);
  const TimeNs now_ns = here_.map.now_ns();
  const Renumbered as = here_.edit.take_in(there_.map);
  const MapCamera& now = here_.map.camera(as.new_id(kCam0));
  EXPECT_EQ(now.past.first_ns, now_ns + 1'000'000'000);
  EXPECT_EQ(now.past.until, as.new_id(SetId(4)));
  EXPECT_EQ(now.frames_in_map(as.new_id(there_.id)), placed);
  EXPECT_EQ(now.frames_ever(), camera.frames_ever());
}

TEST_F(TakenInTest, TheResultIsAMapThatCanBeWrittenAndRead) {
  here_.edit.take_in(there_.map);
  here_.edit.take_in(there_.map);
  Tables tables;
  for (Row& row : MapRows().changes(here_.map)) tables[row.table][row.key] = std::move(row.bytes);
  MapEdit read{MapConfig()};
  read.restore(tables);
  EXPECT_EQ(test::Difference(test::Compared::kKept).of(read.map(), here_.map), "");
}

TEST_F(TakenInTest, AnEmptyMapBecomesTheOther) {
  MapEdit empty{MapConfig()};
  const Renumbered as = empty.take_in(there_.map);
  EXPECT_EQ(as.new_id(kCam0), kCam0);
  EXPECT_EQ(as.new_id(there_.id), there_.id);
  EXPECT_EQ(empty.map().points().size(), there_.map.points().size() - 1);
  EXPECT_EQ(empty.map().cameras()[0].name, "cam0");
  test::expect_consistent(empty.map());
}

}  // namespace
}  // namespace coslam::import_pen_test
