// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/scale.h"

#include <gmock/gmock.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.h"
#include "common/model/rig.h"
#include "server/estimator/map/serialise.h"
#include "tests/support/sim_map.h"
#include "tests/support/temp_folder.h"

// Rigs and known baselines. Tags are in tag_scale_test.cpp.
namespace coslam::scale_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr CameraId kCam0(0), kCam1(1);
const Rigid3 kRightFromLeft(so3_exp({0, 0.05, 0}), {-0.3, 0, 0});

// Two cameras fixed to each other, in a map whose unit of length is 2 m at the beginning.
class ScaleTest : public testing::Test {
 protected:
  void start(const MapConfig& config) {
    const test::CameraPath left = test::wave_path({});
    const test::CameraPath right = [left](double t_s) { return kRightFromLeft * left(t_s); };
    sim_ = std::make_unique<test::SimMap>(world_, std::vector{left, right}, test::TrackingConfig(), config);
  }
  void start_with_rig(const Rigid3& cam1_from_cam0) {
    MapConfig config;
    config.rigs = {text_of({"cam1", "cam0", cam1_from_cam0})};
    start(config);
  }
  // The next set; both cameras are placed as truth has them in the map as it is by now.
  ScaleReport step(Scale& scale) {
    sim_->ingest();
    for (const CameraId c : {kCam0, kCam1}) {
      sim_->place(c, in_, transform_world(sim_->truth(c, sim_->set.id), map_from_world()));
    }
    return scale.run(sim_->edit, sim_->set, {});
  }
  Similarity3 map_from_world() const {
    Similarity3 out{0.5, Eigen::Quaterniond::Identity(), {0, 0, 0}};
    for (const MapMove& m : sim_->map.moves()) out = m.into_from_from * out;
    return out;
  }
  double apart(SetId set) const {
    const FramePose *a = sim_->map.camera(kCam0).frame_at(set), *b = sim_->map.camera(kCam1).frame_at(set);
    return (a->cam_from_world.center() - b->cam_from_world.center()).norm();
  }

  const test::SimWorld world_{{.points = 30}};
  std::unique_ptr<test::SimMap> sim_;
  MapId in_{1};
};

TEST_F(ScaleTest, ARigTellsMetresOnce) {
  start_with_rig(kRightFromLeft);
  Scale scale({});
  const ScaleReport first = step(scale);
  EXPECT_THAT(first.in_metres, ElementsAre(in_));
  EXPECT_THAT(first.doubts, IsEmpty());
  EXPECT_TRUE(sim_->map.is_metric(in_));
  EXPECT_NEAR(apart(SetId(0)), 0.3, 1e-9);
  EXPECT_NEAR(map_from_world().scale, 1, 1e-9);
  for (int i = 0; i < 5; ++i) EXPECT_THAT(step(scale).in_metres, ElementsAre(in_));
  EXPECT_EQ(sim_->map.moves().size(), 1U);
  EXPECT_THAT(scale.finish(sim_->edit).in_metres, ElementsAre(in_));
  EXPECT_EQ(sim_->map.moves().size(), 1U);
}

TEST_F(ScaleTest, ARigNeedsTwoOfItsCamerasInTheMap) {
  start_with_rig(kRightFromLeft);
  Scale scale({});
  for (int i = 0; i < 3; ++i) {
    sim_->ingest();
    sim_->place_truly(kCam1);
    EXPECT_THAT(scale.run(sim_->edit, sim_->set, {}).in_metres, IsEmpty());
  }
  sim_->ingest();
  sim_->place_truly(kCam1);
  sim_->place(kCam0, sim_->edit.new_map(Why::kStartedAlone, 1), Rigid3());
  EXPECT_THAT(scale.run(sim_->edit, sim_->set, {}).in_metres, IsEmpty()) << "they are in two maps";
}

TEST_F(ScaleTest, ARigThatTheImagesContradictIsDoubtedAfterAWhile) {
  start_with_rig(kRightFromLeft.inverse());
  Scale scale({});
  std::vector<std::string> doubts;
  for (int i = 0; i < 60; ++i) {
    const ScaleReport report = step(scale);
    EXPECT_THAT(report.in_metres, IsEmpty());
    EXPECT_TRUE(i >= 20 || report.doubts.empty()) << "poses may still settle";
    doubts.insert(doubts.end(), report.doubts.begin(), report.doubts.end());
  }
  ASSERT_EQ(doubts.size(), 1U);
  EXPECT_THAT(doubts[0],
              HasSubstr("the rig has cam1 left, turned by 3 degrees against cam0, the images have it right"));
  EXPECT_THAT(doubts[0], HasSubstr("it is the inverse of what is expected"));
  EXPECT_THAT(sim_->map.moves(), IsEmpty());
}

TEST_F(ScaleTest, ARigInMillimetresIsDoubted) {
  start_with_rig({kRightFromLeft.rotation, 1000 * kRightFromLeft.translation});
  Scale scale({});
  const ScaleReport report = step(scale);
  ASSERT_EQ(report.doubts.size(), 1U);
  EXPECT_THAT(report.doubts[0], HasSubstr("the rig has cam1 300 m from cam0: metres are expected"));
  EXPECT_THAT(step(scale).doubts, IsEmpty()) << "once";
}

TEST_F(ScaleTest, AKnownBaselineIsThatOfTheFirstCommonInstant) {
  start({});
  Scale scale({.baseline_m = 0.3});
  EXPECT_THAT(scale.held_frames(), IsEmpty());
  EXPECT_THAT(step(scale).in_metres, ElementsAre(in_));
  EXPECT_NEAR(apart(SetId(0)), 0.3, 1e-9);
  for (int i = 0; i < 5; ++i) EXPECT_THAT(step(scale).in_metres, ElementsAre(in_));
  EXPECT_EQ(sim_->map.moves().size(), 1U) << "once";
  EXPECT_THAT(scale.held_frames(), ElementsAre(ImageKey(SetId(0), kCam0), ImageKey(SetId(0), kCam1)));
}

TEST_F(ScaleTest, OneCameraAloneHasNoBaseline) {
  test::SimMap alone(world_, {test::wave_path({})});
  Scale scale({.baseline_m = 0.3});
  alone.advance();
  EXPECT_THAT(scale.run(alone.edit, alone.set, {}).in_metres, IsEmpty());
  EXPECT_THAT(scale.finish(alone.edit).in_metres, IsEmpty());
}

TEST_F(ScaleTest, CamerasAtOnePlaceHaveNoBaseline) {
  start({});
  Scale scale({.baseline_m = 0.3});
  sim_->ingest();
  for (const CameraId c : {kCam0, kCam1}) sim_->place(c, in_, Rigid3());
  EXPECT_THAT(scale.run(sim_->edit, sim_->set, {}).in_metres, IsEmpty());
}

TEST_F(ScaleTest, ABaselineIsLookedForAgainWhenItsMapBecamePartOfAnother) {
  start({});
  Scale scale({.baseline_m = 0.3});
  step(scale);
  const MapId other = sim_->edit.new_map(Why::kStartedAlone, 1);
  sim_->edit.merge(in_, other, {4, Eigen::Quaterniond::Identity(), {1, 0, 0}});
  in_ = other;
  EXPECT_NEAR(apart(SetId(0)), 1.2, 1e-9);
  EXPECT_THAT(step(scale).in_metres, ElementsAre(other));
  EXPECT_NEAR(apart(SetId(0)), 0.3, 1e-9);
}

TEST_F(ScaleTest, AtTheEndTheBaselineIsThatOfTheFinalPoses) {
  start({});
  Scale scale({.baseline_m = 0.3});
  step(scale);
  step(scale);
  const MapCamera& camera = sim_->map.camera(kCam1);
  const FramePose& first = camera.frames.front();
  Rigid3 aside = first.cam_from_world;
  aside.translation.x() -= 0.1;
  sim_->edit.adjust_pose(camera, first, aside);
  ASSERT_GT(std::abs(apart(SetId(0)) - 0.3), 0.05);
  EXPECT_THAT(scale.finish(sim_->edit).in_metres, ElementsAre(in_));
  EXPECT_NEAR(apart(SetId(0)), 0.3, 1e-9);
}

TEST_F(ScaleTest, WithoutAnythingKnownNoMapIsInMetres) {
  start({});
  Scale scale({});
  const ScaleReport report = step(scale);
  EXPECT_THAT(report.in_metres, IsEmpty());
  EXPECT_THAT(scale.finish(sim_->edit).in_metres, IsEmpty());
  EXPECT_THAT(sim_->map.moves(), IsEmpty());
}

// What another run knew of the lengths of a map, as its file has it.
Scale read_again(const Scale& scale) {
  std::vector<Row> rows;
  scale.save(&rows);
  Tables tables;
  for (Row& row : rows) tables[row.table][row.key] = std::move(row.bytes);
  Scale read({});
  read.restore(tables);
  return read;
}

TEST_F(ScaleTest, MetresOutliveTheRunThatKnewThem) {
  start_with_rig(kRightFromLeft);
  Scale by_rig({});
  step(by_rig);
  Scale by_baseline({.baseline_m = 0.3});
  start({});
  step(by_baseline);
  for (const Scale* known : {&by_rig, &by_baseline}) {
    Scale later = read_again(*known);
    EXPECT_THAT(step(later).in_metres, ElementsAre(in_));
    EXPECT_THAT(later.finish(sim_->edit).in_metres, ElementsAre(in_));
  }
  Scale ignorant = read_again(Scale({}));
  EXPECT_THAT(step(ignorant).in_metres, IsEmpty());
}

TEST_F(ScaleTest, DamagedRowsAreRefused) {
  Scale scale({});
  const auto row = static_cast<std::int64_t>(StateRow::kScale);
  EXPECT_THAT(test::error_of<UserError>([&] {
                scale.restore({{"state", {{row, "\x07"}}}});
              }),
              HasSubstr("not what it should be"));
  EXPECT_EQ(test::error_of<UserError>([&] { scale.restore({}); }), "");
}

}  // namespace
}  // namespace coslam::scale_test
