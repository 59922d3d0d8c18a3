// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/past/forget.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "tests/support/map_checks.h"
#include "tests/support/sim_map.h"
#include "tests/support/sim_run.h"

// A long run in a place that it knows: what stays in memory, and what is given out.
namespace coslam::forget_test {
namespace {

using test::SimRun;
using test::SimWorld;

constexpr double kWhole_s = 3;
constexpr int kWhole = 90;  // frame sets

MapServerConfig forgetful() {
  MapServerConfig config;
  config.of<ForgetConfig>().whole_s = kWhole_s;
  config.of<ForgetConfig>().block_s = 0.5;
  return config;
}

class ForgettingRun : public testing::Test {
 protected:
  ForgettingRun() {
    for (const auto& path : test::paths_side_by_side(2)) run_.add_agent(path);
  }
  void step(int sets) {
    for (int i = 0; i < sets; ++i) {
      run_.step();
      const PastPart past = run_.server().take_past();
      for (const PastFrames& block : past.frames) blocks_.push_back(block);
      if (past.places) places_.push_back(*past.places);
    }
  }
  std::size_t frames_in_memory() const {
    std::size_t n = 0;
    for (const MapCamera& c : run_.map().cameras()) n += c.frames.size();
    return n;
  }
  std::size_t observations() const {
    std::size_t n = 0;
    for (const auto& [id, p] : run_.map().points()) n += p.key_observations.size();
    return n;
  }

  const SimWorld world_{{.moving_points = 40}};
  SimRun run_{world_, forgetful()};
  std::vector<PastFrames> blocks_;
  std::vector<PastPlaces> places_;
};

TEST_F(ForgettingRun, NothingLeavesAShortOne) {
  step(kWhole - 1);
  EXPECT_TRUE(blocks_.empty());
  EXPECT_TRUE(places_.empty());
  EXPECT_EQ(frames_in_memory(), 2U * (kWhole - 1));
}

TEST_F(ForgettingRun, EachFrameIsInMemoryOrGivenOutOnce) {
  step(6 * kWhole);
  for (const MapCamera& c : run_.map().cameras()) {
    std::vector<std::uint32_t> sets;
    for (const PastFrames& block : blocks_) {
      if (block.camera != c.id) continue;
      for (const FramePose& f : block.frames) sets.push_back(f.set.value);
    }
    EXPECT_EQ(static_cast<int>(sets.size()), c.past.frames);
    for (const FramePose& f : c.present_frames()) sets.push_back(f.set.value);
    ASSERT_EQ(sets.size(), 6U * kWhole);
    for (std::size_t i = 0; i < sets.size(); ++i) ASSERT_EQ(sets[i], i);
    EXPECT_EQ(c.frames_ever(), sets.size());
    EXPECT_LT(c.frames.size(), 2U * kWhole);
  }
  EXPECT_EQ(run_.server().maps().front().frames.at(CameraId(0)), 6 * kWhole);
  test::expect_consistent(run_.map());
}

TEST_F(ForgettingRun, ThePastFollowsTheMap) {
  step(4 * kWhole);
  run_.server().finish();
  std::vector<Eigen::Vector3d> estimated, truth;
  for (const PastFrames& block : blocks_) {
    for (const FramePose& f : frames_now(run_.map(), block)) {
      ASSERT_TRUE(f.valid());
      EXPECT_EQ(f.map, run_.server().largest_map());
      estimated.push_back(f.cam_from_world.center());
      truth.push_back(run_.truth(block.camera, f.capture_ns).center());
    }
  }
  const test::PathError present = run_.path_error();
  double sum2 = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sum2 += (present.truth_from_map * estimated[i] - truth[i]).squaredNorm();
  }
  EXPECT_LT(std::sqrt(sum2 / static_cast<double>(truth.size())), 0.02);
}

TEST_F(ForgettingRun, WhatMovedIsGivenOutAsItsCamerasSawIt) {
  step(4 * kWhole);
  ASSERT_FALSE(places_.empty());
  std::map<std::pair<CameraId, SetId>, FramePose> frames;
  for (const PastFrames& block : blocks_) {
    for (const FramePose& f : frames_now(run_.map(), block)) frames[{block.camera, f.set}] = f;
  }
  TimeNs last_ns = 0;
  int compared = 0;
  for (const PastPlaces& part : places_) {
    for (const PastPlace& place : part.places) {
      EXPECT_GE(place.t_ns, last_ns);
      last_ns = place.t_ns;
      EXPECT_GE(place.views, 2);
      compared += frames.contains({place.camera, place.set}) ? 1 : 0;
    }
  }
  EXPECT_GT(compared, 100);
  for (const auto& [id, path] : run_.map().motions()) EXPECT_GT(path.front().set.value, 2U * kWhole);
}

// In a place that it knows, a run three times as long keeps no more.
TEST_F(ForgettingRun, MemoryIsBoundedByThePlace) {
  step(6 * kWhole);
  const std::size_t points = run_.map().points().size(), views = observations(), keys = run_.map().key_frames().size(),
                    places = run_.server().memory().at("places");
  step(12 * kWhole);
  EXPECT_LT(run_.map().points().size(), 1.2 * static_cast<double>(points));
  EXPECT_LT(observations(), 1.2 * static_cast<double>(views));
  EXPECT_LT(run_.map().key_frames().size(), 1.3 * static_cast<double>(keys));
  EXPECT_LT(run_.server().memory().at("places"), 1.3 * static_cast<double>(places));
  EXPECT_LT(run_.path_error(CameraId(0)).ate, 0.01);
}

TEST_F(ForgettingRun, GoesOnFromAFile) {
  step(4 * kWhole);
  run_.save();
  const int past = run_.map().camera(CameraId(0)).past.frames;
  run_.restore_server(30);
  EXPECT_EQ(run_.map().camera(CameraId(0)).past.frames, past);
  const std::size_t before = blocks_.size();
  step(4 * kWhole);
  EXPECT_GT(blocks_.size(), before);
  std::set<SetId> sets;
  for (const PastFrames& block : blocks_) {
    if (block.camera != CameraId(0)) continue;
    for (const FramePose& f : block.frames) EXPECT_TRUE(sets.insert(f.set).second) << "twice";
  }
  EXPECT_EQ(static_cast<int>(sets.size()), run_.map().camera(CameraId(0)).past.frames);
  EXPECT_EQ(run_.server().maps().size(), 1U);
  test::expect_consistent(run_.map());
}

// Moves of whole maps are exact for what is past, corrections of the frames that stay are shared out between them.
TEST(PastFrames, AreWhereTheMapHasThemNow) {
  const SimWorld world({});
  test::SimMap sim(world, test::paths_side_by_side(1));
  sim.advance(20);
  const MapCamera& camera = sim.map.camera(CameraId(0));
  const std::vector<FramePose> before = camera.frames;
  const ArchivedPlace put = put_down_now(sim.map);
  const PastFrames block{put, camera.id, sim.edit.take_frames(camera, SetId(11), {SetId(0), SetId(10)})};
  ASSERT_EQ(block.frames.size(), 11U);
  EXPECT_EQ(camera.frames.size(), 2U + 9U);
  const Similarity3 to_metres{2.5, Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY())), {1, 2, 3}};
  sim.edit.transform(sim.id, to_metres, Why::kScaleKnown);
  std::vector<FramePose> now = frames_now(sim.map, block);
  for (std::size_t i = 0; i < now.size(); ++i) {
    const Rigid3 want = transform_world(before[i].cam_from_world, to_metres);
    EXPECT_LT((now[i].cam_from_world.center() - want.center()).norm(), 1e-9) << i;
    EXPECT_LT(now[i].cam_from_world.rotation.angularDistance(want.rotation), 1e-7) << i;
  }
  // The newer end is corrected by 0.1 to the side.
  const Eigen::Vector3d by(0.1, 0, 0);
  const FramePose& end = *camera.frame_at(SetId(10));
  const Rigid3 corrected = end.cam_from_world * Rigid3(Eigen::Quaterniond::Identity(), -by);
  const std::vector<FramePose> uncorrected = now;
  sim.edit.adjust_pose(camera, end, corrected);
  now = frames_now(sim.map, block);
  for (std::size_t i = 0; i < now.size(); ++i) {
    const Eigen::Vector3d shift = now[i].cam_from_world.center() - uncorrected[i].cam_from_world.center();
    EXPECT_NEAR(shift.x(), 0.01 * static_cast<double>(i), 1e-3) << i;
  }
  const PastFrames again = past_frames_of(octets_of_past(block));
  EXPECT_EQ(again.frames.size(), block.frames.size());
  EXPECT_EQ(again.camera, block.camera);
  EXPECT_EQ(frames_now(sim.map, again)[5].cam_from_world.translation, now[5].cam_from_world.translation);
}

}  // namespace
}  // namespace coslam::forget_test
