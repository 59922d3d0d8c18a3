// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/refine.h"
#include "server/estimator/adjust/apply_refine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "common/geometry/alignment.h"
#include "server/estimator/adjust/bundle_adjustment.h"
#include "tests/server/estimator/adjust/drifted_map.h"
#include "tests/support/map_fit.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam::refine_test {
namespace {

using test::PoseNear;
using test::VectorNear;

TEST_F(RefineTest, TheWindowIsFreeAndHistoryHoldsIt) {
  const RefineJob job = plan();
  EXPECT_EQ(job.map, sim_.id);
  EXPECT_EQ(job.epoch, sim_.map.epoch());
  EXPECT_FALSE(job.floating);
  ASSERT_EQ(job.poses.size(), job.problem.poses.size());
  ASSERT_EQ(job.points.size(), job.problem.points.size());
  ASSERT_EQ(job.observations.size(), job.problem.observations.size());
  int free = 0, fixed = 0;
  for (std::size_t i = 0; i < job.poses.size(); ++i) {
    const bool in_window = job.poses[i].set.value >= 3 * kKeyEvery;  // the newest 8 of 11
    EXPECT_EQ(job.problem.poses[i].fixed, !in_window);
    ++(in_window ? free : fixed);
  }
  EXPECT_EQ(free, 8 * 3);
  EXPECT_GT(fixed, 2);
  for (const auto& o : job.problem.observations) {
    EXPECT_LT(static_cast<std::size_t>(o.pose), job.poses.size());
    EXPECT_LT(static_cast<std::size_t>(o.point), job.points.size());
  }
}

TEST_F(RefineTest, AllViewsOfOneTrackAreWorthTwoInTheWholeMap) {
  const auto most = [&](const RefineJob& job) {
    std::map<std::tuple<int, CameraId, TrackId>, double> worth;
    double largest = 0;
    for (std::size_t i = 0; i < job.observations.size(); ++i) {
      const auto& o = job.problem.observations[i];
      double& sum = worth[{o.point, job.poses[static_cast<std::size_t>(o.pose)].camera, job.observations[i].track}];
      sum += o.weight;
      largest = std::max(largest, sum);
    }
    return largest;
  };
  EXPECT_NEAR(most(plan(RefineExtent::kWhole)), 2, 1e-9);
  EXPECT_GT(most(plan()), 4) << "within a window they count one by one";
}

class RefineWithAJointPose : public RefineTest {
 protected:
  static constexpr int kSet = 48, kCamera = 1;
  RefineWithAJointPose() : RefineTest({.joint_set = kSet, .spoilt_set = -1}) {}
};

TEST_F(RefineWithAJointPose, ItIsCarriedAndNotAdjusted) {
  const RefineJob job = plan();
  EXPECT_EQ(std::ranges::count(job.problem.poses, false, &BundleProblem::Pose::fixed), 8 * 3 - 1);
  for (const auto& p : job.poses) EXPECT_FALSE(p.camera == cam(kCamera) && p.set == SetId(kSet));
  ASSERT_TRUE(apply_refine(sim_.edit, job, solve_refine(job)).applied);
  EXPECT_LT((pose(kCamera, kSet).center() - truth(kCamera, kSet).center()).norm(), 0.02);
}

TEST_F(RefineTest, KeyFramesAndTheFramesBetweenComeRight) {
  EXPECT_GT(worst_m(18, kSets - 1), 0.07);
  const MapEpoch before = sim_.map.epoch();
  const RefineReport report = refine();
  ASSERT_TRUE(report.applied);
  EXPECT_GT(sim_.map.epoch(), before);
  EXPECT_EQ(report.poses, static_cast<int>(plan().poses.size()));
  EXPECT_GT(report.points, 200);
  EXPECT_NEAR(report.sigma_px, 0.3, 0.1);
  EXPECT_LT(worst_m(18, 60), 0.015) << "key frames and all between them";
  EXPECT_LT(worst_m(61, kSets - 1), 0.03) << "frames after the last are carried along with it";
}

TEST_F(RefineTest, WhatIsBeforeTheWindowStays) {
  std::vector<Rigid3> before;
  for (int s = 0; s <= 12; ++s) before.push_back(pose(1, s));
  refine();
  for (int s = 0; s <= 12; ++s) {
    EXPECT_THAT(pose(1, s), PoseNear(before[static_cast<std::size_t>(s)], 1e-7, 1e-9)) << s;
  }
}

TEST_F(RefineTest, FramesAfterTheLastKeyFrameKeepTheirMotion) {
  const Rigid3 motion = pose(2, 65) * pose(2, 60).inverse(), old_last = pose(2, 65);
  refine();
  EXPECT_THAT(pose(2, 65) * pose(2, 60).inverse(), PoseNear(motion, 1e-7, 1e-9));
  // And the agent is told of the same change.
  EXPECT_THAT(transform_world(old_last, sim_.map.camera(cam(2)).moved), PoseNear(pose(2, 65), 1e-7, 1e-9));
}

TEST_F(RefineTest, PathsStaySmooth) {
  refine();
  for (int c = 0; c < 3; ++c) {
    for (int s = 1; s < kSets; ++s) {
      const double step = (pose(c, s).center() - pose(c, s - 1).center()).norm();
      EXPECT_LT(step, (truth(c, s).center() - truth(c, s - 1).center()).norm() + 0.01) << c << ' ' << s;
    }
  }
}

TEST_F(RefineTest, PointsComeRightAndKnowHowWell) {
  refine();
  std::vector<double> errors, values;
  for (const auto& [id, p] : sim_.map.points()) {
    const int point = sim_.world_point(p);
    if (point < 0 || p.bound.empty()) continue;
    errors.push_back((p.position - world_.position(point)).norm());
    values.push_back(test::nees(p.position - world_.position(point), p.covariance));
  }
  EXPECT_GT(errors.size(), 100U);
  EXPECT_LT(test::median(errors), 0.02);
  EXPECT_LT(test::median(values), 8);
}

TEST_F(RefineTest, TheWholeRunFloatsAndIsPutBackToWhereItWas) {
  const RefineJob job = plan(RefineExtent::kWhole);
  EXPECT_TRUE(job.floating);
  EXPECT_EQ(job.poses.size(), 11U * 3);
  const BundleResult solved = solve_refine(job);
  std::vector<Eigen::Vector3d> before, after;
  for (std::size_t i = 0; i < job.poses.size(); ++i) {
    before.push_back(job.problem.poses[i].cam_from_world.center());
    after.push_back(solved.poses[i].center());
  }
  const Alignment left = align_points(after, before, AlignmentScale::kFree);
  ASSERT_TRUE(left.target_from_source);
  EXPECT_NEAR(left.target_from_source->scale, 1, 0.01);
  EXPECT_LT(Eigen::AngleAxisd(left.target_from_source->rotation).angle(), 0.01);
  EXPECT_TRUE(apply_refine(sim_.edit, job, solved).applied);
  // The scale is that of the drifted baseline, so poses are right but for a few percent of their distance.
  EXPECT_LT(worst_m(0, 60), 0.08);
}

TEST_F(RefineTest, AnOldJobIsDropped) {
  const RefineJob job = plan();
  const BundleResult solved = solve_refine(job);
  sim_.edit.raise_epoch();
  const Rigid3 before = pose(0, 60);
  const MapEpoch epoch = sim_.map.epoch();
  EXPECT_FALSE(apply_refine(sim_.edit, job, solved).applied);
  EXPECT_EQ(pose(0, 60).translation, before.translation);
  EXPECT_EQ(sim_.map.epoch(), epoch);
}

TEST_F(RefineTest, AnUnusableSolutionIsDropped) {
  const RefineJob job = plan();
  BundleResult solved = solve_refine(job);
  solved.usable = false;
  EXPECT_FALSE(apply_refine(sim_.edit, job, solved).applied);
}

TEST_F(RefineTest, WhatWasFoundToMoveMeanwhileIsLeftAlone) {
  const RefineJob job = plan();
  const MapPoint& p = *sim_.map.find(job.points.front());
  const Eigen::Vector3d there = p.position + Eigen::Vector3d(0.1, 0, 0);
  sim_.edit.start_moving(p, there, p.covariance, Why::kSeenElsewhere);
  apply_refine(sim_.edit, job, solve_refine(job));
  const MapPoint* after = sim_.map.find(job.points.front());
  ASSERT_NE(after, nullptr) << "it has no key observations any more, but tracks";
  EXPECT_EQ(after->position, there);
}

TEST_F(RefineTest, PosesThatOnlyHoldStayToTheBit) {
  const RefineJob job = plan();
  std::vector<Rigid3> before;
  SetId first_free = sim_.set.id;
  for (std::size_t i = 0; i < job.poses.size(); ++i) {
    if (!job.problem.poses[i].fixed) first_free = std::min(first_free, job.poses[i].set);
  }
  for (const MapCamera& c : sim_.map.cameras()) {
    for (const FramePose& f : c.frames) before.push_back(f.cam_from_world);
  }
  apply_refine(sim_.edit, job, solve_refine(job));
  std::size_t k = 0;
  int stayed = 0;
  for (const MapCamera& c : sim_.map.cameras()) {
    for (const FramePose& f : c.frames) {
      const Rigid3& was = before[k++];
      if (f.set.value + kKeyEvery > first_free.value) continue;
      EXPECT_EQ(f.cam_from_world.translation, was.translation);
      ++stayed;
    }
  }
  EXPECT_GT(stayed, 30);
}

TEST_F(RefineTest, WhatWasRemovedMeanwhileStaysRemoved) {
  const RefineJob job = plan();
  const BundleResult solved = solve_refine(job);
  for (std::size_t i = 0; i < 20; ++i) sim_.edit.remove_point(*sim_.map.find(job.points[i]), Why::kTooFewViews);
  const std::size_t left = sim_.map.points().size();
  EXPECT_TRUE(apply_refine(sim_.edit, job, solved).applied);
  EXPECT_LE(sim_.map.points().size(), left);
  EXPECT_EQ(sim_.map.find(job.points[3]), nullptr);
  EXPECT_LT(worst_m(18, 60), 0.015);
}

TEST_F(RefineTest, AnOutlineAdjustsSomeKeyFramesAndCarriesTheOthers) {
  const int all = static_cast<int>(plan(RefineExtent::kWhole).poses.size());
  config_.outline_poses = (all + 1) / 2;
  const RefineJob job = plan(RefineExtent::kOutline);
  EXPECT_LE(static_cast<int>(job.poses.size()), config_.outline_poses);
  EXPECT_GE(static_cast<int>(job.poses.size()), config_.outline_poses - 6);
  EXPECT_EQ(job.poses.front().set, sim_.map.key_frames().front().set);
  EXPECT_TRUE(std::ranges::any_of(job.poses, [&](const auto& p) { return p.set == sim_.map.key_frames().back().set; }));
  const double before_m = test::fit_of(sim_, sim_.id).worst_pose_m;
  ASSERT_TRUE(apply_refine(sim_.edit, job, solve_refine(job)).applied);
  // Its frame and scale are nobody's.
  const double after_m = test::fit_of(sim_, sim_.id).worst_pose_m;
  EXPECT_LT(after_m, 0.35 * before_m) << "between its key frames too";
  config_.outline_poses = all;
  EXPECT_EQ(static_cast<int>(plan(RefineExtent::kOutline).poses.size()), all) << "all of a small map";
}

TEST_F(RefineTest, TheOutlineOfALongRunIsOfWhatChanged) {
  const auto& keys = sim_.map.key_frames();
  const auto free_sets = [&](SetId since) {
    const auto job = plan_outline_since(sim_.map, sim_.id, since, config_);
    std::set<SetId> out;
    for (std::size_t i = 0; job && i < job->poses.size(); ++i) {
      if (!job->problem.poses[i].fixed) out.insert(job->poses[i].set);
    }
    return out;
  };
  config_.outline_poses = static_cast<int>(keys.size());  // of three cameras: what an outline may be taken of
  EXPECT_EQ(*free_sets(keys[7].set).begin(), keys.front().set) << "a short run's is of all of it";
  config_.outline_poses = 8;
  EXPECT_EQ(*free_sets(keys[7].set).begin(), keys[7].set);
  EXPECT_EQ(*free_sets(SetId()).begin(), keys[3].set) << "of the newest, no more than may be";
  EXPECT_TRUE(free_sets(keys.back().set).empty()) << "the window's matter";
}

TEST_F(RefineTest, TheOutlineOfWhatChangedIsHeldByWhatIsOlder) {
  const auto& keys = sim_.map.key_frames();
  config_.outline_poses = 8;
  const auto job = plan_outline_since(sim_.map, sim_.id, keys[5].set, config_);
  ASSERT_TRUE(job);
  EXPECT_FALSE(job->floating);
  const Rigid3 before = pose(0, 20);
  const double off_m = worst_m(36, 60);
  ASSERT_TRUE(apply_refine(sim_.edit, *job, solve_refine(*job)).applied);
  EXPECT_THAT(pose(0, 20), PoseNear(before, 1e-12, 1e-12));
  EXPECT_LT(worst_m(36, 60), 0.5 * off_m);
}

TEST_F(RefineTest, FramesThatCameMeanwhileAreCarried) {
  const RefineJob job = plan();
  const BundleResult solved = solve_refine(job);
  for (int i = 0; i < 4; ++i) {
    sim_.advance();
    for (const MapCamera& c : sim_.map.cameras()) {
      sim_.edit.adjust_pose(c, c.frames.back(), drifted(c.frames.back().cam_from_world, sim_.set.id));
    }
  }
  ASSERT_TRUE(apply_refine(sim_.edit, job, solved).applied);
  EXPECT_LT(worst_m(61, kSets + 3), 0.035);
}

TEST_F(RefineTest, PointsOutsideTheJobAreTriangulatedAnew) {
  // New since the last key frame, which holds its only key observations; seen by two cameras now.
  int fresh = 0;
  for (const auto seen = [&](int c) { return sim_.track_of(cam(c), fresh) != nullptr; };
       !(seen(0) && seen(1)) || sim_.track_of(cam(0), fresh)->point != PointId() ||
       sim_.track_of(cam(1), fresh)->point != PointId();) {
    if (++fresh == world_.size()) GTEST_SKIP() << "all are mapped";
  }
  const MapPoint& p = sim_.create(world_.position(fresh) + Eigen::Vector3d(0.3, 0.1, -0.3), 1);
  for (const int c : {0, 1}) {
    const ServerTrack& t = *sim_.track_of(cam(c), fresh);
    sim_.bind(p, cam(c), t);
    for (const KeyFrame& k : sim_.map.key_frames()) sim_.edit.drop_observation(p, k.set, cam(c), t.id);
  }
  ASSERT_TRUE(p.key_observations.empty());
  const RefineJob job = plan();
  EXPECT_EQ(std::count(job.points.begin(), job.points.end(), p.id), 0);
  ASSERT_TRUE(apply_refine(sim_.edit, job, solve_refine(job)).applied);
  EXPECT_THAT(p.position, VectorNear(world_.position(fresh), 0.12));
}

class RefineWithOutliers : public RefineTest {
 protected:
  RefineWithOutliers() : RefineTest({.joint_set = -1, .spoilt_set = 54}) {}
};

TEST_F(RefineWithOutliers, TheyAreTakenOut) {
  ASSERT_EQ(spoilt_.size(), 20U);
  const RefineReport report = refine();
  EXPECT_GE(report.outliers, 19);
  EXPECT_LT(report.outliers, 60);
  int left = 0;
  for (const auto& [id, spoilt] : spoilt_) {
    const auto& all = sim_.map.find(id)->key_observations;
    left += static_cast<int>(std::ranges::count(all, spoilt.undistorted_px, &KeyObservation::undistorted_px) > 0);
  }
  EXPECT_LE(left, 1);
  EXPECT_LT(worst_m(18, 60), 0.02);
}

TEST_F(RefineTest, TooLittleIsNoJob) {
  test::SimMap small(world_, test::paths_side_by_side(2));
  EXPECT_FALSE(plan_refine(small.map, small.id, RefineExtent::kWindow, config_));
  small.advance();
  small.add_points();
  small.edit.add_key_frame(small.set.id);
  EXPECT_FALSE(plan_refine(small.map, small.id, RefineExtent::kWindow, config_)) << "one key frame";
  EXPECT_FALSE(plan_refine(sim_.map, MapId(77), RefineExtent::kWhole, config_)) << "no such map";
  while (sim_.map.points().size() > 19) sim_.edit.remove_point(sim_.map.points().begin()->second, Why::kTooFewViews);
  EXPECT_FALSE(plan_refine(sim_.map, sim_.id, RefineExtent::kWindow, config_)) << "nineteen points";
}

TEST_F(RefineTest, TheFirstWindowHasNoHistoryAndFloats) {
  test::SimMap young(world_, test::paths_side_by_side(2));
  for (int i = 0; i < 13; ++i) {
    young.advance();
    if (i % 6 != 0) continue;
    young.add_points(0.002);
    young.edit.add_key_frame(young.set.id);
  }
  const auto job = plan_refine(young.map, young.id, RefineExtent::kWindow, config_);
  ASSERT_TRUE(job);
  EXPECT_TRUE(job->floating);
  const Rigid3 before = young.map.camera(cam(0)).frames[0].cam_from_world;
  ASSERT_TRUE(apply_refine(young.edit, *job, solve_refine(*job)).applied);
  EXPECT_THAT(young.map.camera(cam(0)).frames[0].cam_from_world, PoseNear(before, 0.005, 0.01));
  EXPECT_THAT(young.map.camera(cam(1)).frames[12].cam_from_world,
              PoseNear(young.truth(cam(1), SetId(12)), 0.005, 0.02));
}

}  // namespace
}  // namespace coslam::refine_test
