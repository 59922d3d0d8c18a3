// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/refiner.h"

#include <gtest/gtest.h>

#include <thread>

#include "common/geometry/camera_model.h"
#include "tests/support/eventually.h"

namespace coslam::refiner_test {
namespace {

const CameraModel kCamera{640, 480, 500, 500, 320, 240, DistortionModel::kNone, {}};

// Points in front of four cameras side by side, two of which hold the map. The points begin 5 cm off their places.
RefineJob job_of(int points = 40) {
  RefineJob job;
  job.problem.cameras = {kCamera};
  for (int i = 0; i < 4; ++i) {
    job.problem.poses.push_back({Rigid3(Eigen::Quaterniond::Identity(), {-0.5 * i, 0, 0}), 0, i < 2});
  }
  for (int p = 0; p < points; ++p) {
    const Eigen::Vector3d place(std::sin(1.3 * p), std::cos(2.1 * p), 5 + 0.5 * std::sin(0.7 * p));
    job.problem.points.emplace_back(place + Eigen::Vector3d(0.05, -0.05, 0.05));
    for (int i = 0; i < 4; ++i) {
      const Rigid3& pose = job.problem.poses[static_cast<std::size_t>(i)].cam_from_world;
      const Eigen::Vector2d px = kCamera.pixel_from_normalized((pose * place).hnormalized());
      job.problem.observations.push_back({i, p, px, 0.5});
    }
  }
  job.config.function_tolerance = 1e-12;
  return job;
}

// The solution, asked for again and again without waiting for it.
std::optional<RefineSolution> poll(Refiner& refiner) {
  const auto end = std::chrono::steady_clock::now() + test::kDeadline;
  while (std::chrono::steady_clock::now() < end) {
    if (auto solution = refiner.take(false)) return solution;
    EXPECT_TRUE(refiner.busy()) << "nothing is lost when it is not there yet";
    std::this_thread::yield();
  }
  return std::nullopt;
}

void expect_solved(const std::optional<RefineSolution>& solution) {
  ASSERT_TRUE(solution);
  ASSERT_TRUE(solution->result.usable);
  EXPECT_LT(solution->result.final_cost, 1e-6 * solution->result.initial_cost);
  EXPECT_EQ(solution->job.problem.observations.size(), 160U) << "with the job that it solves";
  EXPECT_GT(solution->took.count(), 0);
}

class RefinerTest : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Threads, RefinerTest, ::testing::Bool(),
                         [](const auto& made) { return made.param ? "Threaded" : "Inline"; });

TEST_P(RefinerTest, AJobComesBackSolved) {
  Refiner refiner(GetParam());
  refiner.start(job_of(), SetId(1));
  EXPECT_TRUE(refiner.busy());
  expect_solved(refiner.take(true));
  EXPECT_FALSE(refiner.busy());
  refiner.start(job_of(), SetId(9));
  expect_solved(refiner.take(true));
}

TEST_P(RefinerTest, WhatIsNotThereYetIsNotLost) {
  Refiner refiner(GetParam());
  for (int i = 0; i < 5; ++i) {
    refiner.start(job_of(), SetId(1));
    expect_solved(poll(refiner));
    EXPECT_FALSE(refiner.busy());
  }
}

TEST_P(RefinerTest, NothingIsWaitedForWhenNothingWasStarted) {
  Refiner refiner(GetParam());
  EXPECT_FALSE(refiner.take(true));
  EXPECT_FALSE(refiner.take_due(SetId(100), true));
  refiner.start(job_of(), SetId(1));
  EXPECT_TRUE(refiner.take(true));
  EXPECT_FALSE(refiner.take(true)) << "once only";
}

TEST_P(RefinerTest, InLockstepASolutionIsTakenWhenItIsDue) {
  Refiner refiner(GetParam());
  refiner.start(job_of(), SetId(10));
  EXPECT_FALSE(refiner.take_due(SetId(11), true));
  EXPECT_FALSE(refiner.take_due(SetId(12), true)) << "not sooner, however fast the machine is";
  expect_solved(refiner.take_due(SetId(13), true));
  refiner.start(job_of(), SetId(13));
  expect_solved(refiner.take_due(SetId(20), true));
}

TEST_P(RefinerTest, LiveItIsTakenWhenItIsThere) {
  Refiner refiner(GetParam());
  refiner.start(job_of(), SetId(10));
  const auto end = std::chrono::steady_clock::now() + test::kDeadline;
  std::optional<RefineSolution> solution;
  while (!solution && std::chrono::steady_clock::now() < end) solution = refiner.take_due(SetId(11), false);
  expect_solved(solution);
}

TEST(Refiner, AThreadOfItsOwnChangesNothing) {
  Refiner threaded(true), in_caller(false);
  threaded.start(job_of(), SetId(1));
  in_caller.start(job_of(), SetId(1));
  const auto a = threaded.take(true), b = in_caller.take(true);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->result.points, b->result.points);
  ASSERT_EQ(a->result.poses.size(), b->result.poses.size());
  for (std::size_t i = 0; i < a->result.poses.size(); ++i) {
    EXPECT_EQ(a->result.poses[i].translation, b->result.poses[i].translation);
    EXPECT_EQ(a->result.poses[i].rotation.coeffs(), b->result.poses[i].rotation.coeffs());
  }
  EXPECT_EQ(a->result.final_cost, b->result.final_cost);
}

TEST(Refiner, EndsWhileAJobIsInWork) {
  for (int i = 0; i < 5; ++i) {
    Refiner refiner(true);
    refiner.start(job_of(1000), SetId(1));
  }
  SUCCEED() << "the test's time limit is the check";
}

}  // namespace
}  // namespace coslam::refiner_test
