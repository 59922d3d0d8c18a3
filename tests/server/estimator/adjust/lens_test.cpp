// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/lens.h"

#include <gtest/gtest.h>

#include <cmath>

#include "server/estimator/adjust/bundle_adjustment.h"
#include "tests/server/estimator/adjust/drifted_map.h"

namespace coslam::lens_test {
namespace {

using LensTest = RefineTest;

TEST_F(LensTest, LensesThatAreAsCalibratedStaySo) {
  adjust_whole(sim_.edit, sim_.id, config_);
  for (const MapCamera& c : sim_.map.cameras()) EXPECT_TRUE(c.lens.none());
}

// As if the second camera had been calibrated with a focal length 4 % too long.
TEST_F(LensTest, ALensThatIsNotAsCalibratedIsFoundAndOthersStay) {
  RefineJob job = plan(RefineExtent::kWhole);
  job.problem.cameras[1].fx *= 1.04;
  job.problem.cameras[1].fy *= 1.04;
  const BundleResult result = solve_refine(job);
  ASSERT_TRUE(result.usable);
  EXPECT_NEAR(std::exp(result.lenses[1].log_focal()), 1 / 1.04, 0.01);
  for (const std::size_t other : {0, 2}) EXPECT_TRUE(result.lenses[other].none());
}

// As of a camera that is in another map: the prior alone would take its lens back to the calibration.
TEST_F(LensTest, ALensThatAJobSeesNothingOfStays) {
  LensCorrection lens;
  lens.values[0] = 0.02;
  sim_.edit.correct_lens(sim_.map.camera(cam(1)), lens, LensCorrection::Values::Zero());
  RefineJob job = plan(RefineExtent::kWhole);
  for (std::size_t i = job.observations.size(); i-- > 0;) {
    const auto pose = static_cast<std::size_t>(job.problem.observations[i].pose);
    if (job.poses[pose].camera != cam(1)) continue;
    job.observations.erase(job.observations.begin() + static_cast<std::ptrdiff_t>(i));
    job.problem.observations.erase(job.problem.observations.begin() + static_cast<std::ptrdiff_t>(i));
  }
  job.problem.lenses.clear();
  free_lenses(sim_.map, &job);
  EXPECT_FALSE(job.problem.lenses[1].free);
  EXPECT_TRUE(job.problem.lenses[0].free);
  EXPECT_EQ(solve_refine(job).lenses[1], sim_.map.camera(cam(1)).lens);
}

// Half of a map that is larger than the other, as where a map began through a wrong lens: what both halves see is many
// pixels off, and hardly felt by the loss that is made for outliers.
TEST_F(LensTest, WhatAWrongLensMadeComesAlong) {
  RefineJob job = plan(RefineExtent::kWhole);
  job.problem.cameras[1].fx *= 1.04;
  job.problem.cameras[1].fy *= 1.04;
  const BundleResult expected = solve_with_lenses(job);
  const BundleProblem right = job.problem;
  const SetId half(kSets / 2);
  constexpr double kScale = 5;
  std::vector<bool> moves(right.points.size(), false);
  for (std::size_t i = 0; i < right.observations.size(); ++i) {
    const auto& o = right.observations[i];
    if (job.poses[static_cast<std::size_t>(o.pose)].set < half) moves[static_cast<std::size_t>(o.point)] = true;
  }
  for (std::size_t i = 0; i < right.poses.size(); ++i) {
    if (job.poses[i].set < half) job.problem.poses[i].cam_from_world.translation *= kScale;
  }
  for (std::size_t i = 0; i < right.points.size(); ++i) {
    if (moves[i]) job.problem.points[i] *= kScale;
  }
  ASSERT_GT(solve_bundle(job.problem, job.config).final_cost, 1.5 * expected.final_cost) << "an easy case";
  EXPECT_LT(solve_with_lenses(job).final_cost, 1.02 * expected.final_cost);
}

TEST_F(LensTest, LensesThatAreGivenAreNotSolvedFor) {
  config_.lens = "given";
  EXPECT_TRUE(plan(RefineExtent::kWhole).problem.lenses.empty());
  config_.lens = "auto";
  EXPECT_FALSE(plan(RefineExtent::kOutline).problem.lenses.empty());
  EXPECT_TRUE(plan().problem.lenses.empty()) << "a window is too little";
}

}  // namespace
}  // namespace coslam::lens_test
