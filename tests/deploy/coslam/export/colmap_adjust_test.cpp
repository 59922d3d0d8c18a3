// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/colmap_adjust.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/geometry/alignment.h"
#include "tests/deploy/coslam/export/simulated_model.h"

namespace coslam::exporting::colmap_adjust_test {
namespace {

// As if the run had left its poses and points a little off.
void disturb(ColmapModel* model) {
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0, 1);
  for (auto& image : model->images) {
    Vector6d off = Vector6d::NullaryExpr([&] { return normal(random); });
    off.head<3>() *= 0.004;
    off.tail<3>() *= 0.02;
    image.cam_from_world = retract(image.cam_from_world, off);
  }
  for (auto& [id, point] : model->points) {
    point.position += 0.02 * Eigen::Vector3d(normal(random), normal(random), normal(random));
  }
}

double mean_of_tracks(const ColmapModel& model) {
  std::size_t seen = 0;
  for (const auto& [id, point] : model.points) seen += point.track.size();
  return static_cast<double>(seen) / static_cast<double>(model.points.size());
}

// RMS distance of the points from the true ones, after the best similarity.
double rms_of_points(const ColmapModel& model, const ColmapModel& truth) {
  std::vector<Eigen::Vector3d> found, expected;
  for (const auto& [id, point] : model.points) {
    found.push_back(point.position);
    expected.push_back(truth.points.at(id).position);
  }
  const auto aligned = align_points(found, expected, AlignmentScale::kFree);
  return aligned.rmse;
}

Eigen::Vector3d mean_center(const ColmapModel& model) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& image : model.images) sum += image.cam_from_world.center();
  return sum / static_cast<double>(model.images.size());
}

TEST(ColmapAdjust, FindsTheTruthUpToTheNoise) {
  const ColmapModel truth = simulated_model(12, 60, 0);
  ColmapModel model = simulated_model(12, 60, 0.5);
  disturb(&model);
  const double before_px = mean_error_px(model), before = rms_of_points(model, truth);
  adjust_colmap_model(&model);
  EXPECT_GT(before_px, 3);
  EXPECT_NEAR(mean_error_px(model), 0.5 * std::sqrt(M_PI / 2), 0.1) << "what noise of half a pixel leaves";
  EXPECT_LT(rms_of_points(model, truth), 0.016);
  EXPECT_LT(rms_of_points(model, truth), before / 2);
  EXPECT_EQ(model.images.size(), 12U);
  EXPECT_EQ(model.points.size(), truth.points.size()) << "nothing was an outlier";
  EXPECT_GT(mean_of_tracks(model), 0.98 * mean_of_tracks(truth));
}

TEST(ColmapAdjust, TheModelStaysWhereItWas) {
  ColmapModel model = simulated_model(12, 60, 0.5);
  disturb(&model);
  const Eigen::Vector3d before = mean_center(model);
  const double span =
      (model.images.front().cam_from_world.center() - model.images.back().cam_from_world.center()).norm();
  adjust_colmap_model(&model);
  EXPECT_LT((mean_center(model) - before).norm(), 0.02);
  EXPECT_NEAR((model.images.front().cam_from_world.center() - model.images.back().cam_from_world.center()).norm(), span,
              0.06);
}

TEST(ColmapAdjust, ObservationsThatAreWrongLoseTheirPoints) {
  ColmapModel model = simulated_model(12, 60, 0.3);
  std::vector<std::pair<std::size_t, std::size_t>> wrong;
  std::mt19937 random(4);
  for (std::size_t i = 0; i < model.images.size(); ++i) {
    auto& observations = model.images[i].observations;
    for (std::size_t k = i; k < observations.size(); k += 15) {
      observations[k].px += Eigen::Vector2d(12 + random() % 30, random() % 2 == 0 ? 15 : -25);
      wrong.emplace_back(i, k);
    }
  }
  ASSERT_GT(wrong.size(), 30U);
  disturb(&model);
  adjust_colmap_model(&model);
  ASSERT_EQ(model.images.size(), 12U);
  for (const auto& [image, observation] : wrong) {
    EXPECT_EQ(model.images[image].observations[observation].point, PointId()) << image << " " << observation;
  }
  EXPECT_LT(rms_of_points(model, simulated_model(12, 60, 0)), 0.01);
  EXPECT_GT(model.points.size(), 50U);
}

TEST(ColmapAdjust, OneImageOrNoneIsLeftAsItIs) {
  ColmapModel nothing;
  adjust_colmap_model(&nothing);
  EXPECT_TRUE(nothing.images.empty());
  ColmapModel model = simulated_model(4, 30, 0);
  model.images.resize(1);
  const Rigid3 pose = model.images[0].cam_from_world;
  adjust_colmap_model(&model);
  ASSERT_EQ(model.images.size(), 1U);
  EXPECT_EQ(model.images[0].cam_from_world.translation, pose.translation);
}

}  // namespace
}  // namespace coslam::exporting::colmap_adjust_test
