// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/window.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/matchers.h"
#include "tests/support/sim_world.h"

namespace coslam::window_test {
namespace {

using test::PoseNear;

constexpr int kFixed = 10, kPoses = 22;

// A camera that turns by a degree and a half from image to image and hardly moves, among things whose depth nobody
// knows; each is followed for ten images.
class WindowSolve : public testing::Test {
 protected:
  struct Setting {
    double noise_px = 0.3, outliers = 0;
    int known = 0;  // of the things their place is known
    bool at_infinity = false;
  };
  WindowProblem make(const Setting& setting, unsigned seed = 1) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(0, 1);
    WindowProblem p{.camera = &camera_, .sigma_px = setting.noise_px};
    for (int k = 0; k < kPoses; ++k) {
      const double turned = 0.026 * k;
      truth_.push_back({so3_exp({0.2 * turned, turned, 0}), {0.01 * k, 0.004 * k, 0.1 * std::sin(0.2 * k)}});
      p.is_free.push_back(k >= kFixed);
      Vector6d off = Vector6d::Zero();
      for (int i = 0; i < 6 && k >= kFixed; ++i) off[i] = (i < 3 ? 0.01 : 0.05) * normal(random);
      p.cam_from_world.push_back(retract(truth_.back(), off));
    }
    for (int i = 0; i < 500; ++i) {
      const int first = static_cast<int>(uniform(random) * kPoses);
      const double depth = setting.at_infinity ? 1e7 : 1 / (0.1 + 0.6 * uniform(random));
      const Eigen::Vector3d place =
          truth_[first].inverse() * (depth * Eigen::Vector3d(1.2 * uniform(random) - 0.6, uniform(random) - 0.5, 1));
      WindowThing thing;
      for (int k = first; k < std::min(first + 10, kPoses); ++k) {
        const Eigen::Vector3d x = truth_[k] * place;
        if (x.z() < 0.1 || !camera_.contains_raw(camera_.project(x))) continue;
        Eigen::Vector2d px = camera_.project(x) + setting.noise_px * Eigen::Vector2d(normal(random), normal(random));
        if (uniform(random) < setting.outliers) px += Eigen::Vector2d(5 + 20 * uniform(random), -10 * uniform(random));
        thing.seen.emplace_back(k, px);
      }
      if (thing.seen.size() < 2) continue;
      thing.frame_from_world = p.cam_from_world[static_cast<std::size_t>(thing.seen.front().first)];
      const Eigen::Vector2d ray = camera_.normalized_from_pixel(thing.seen.front().second);
      constexpr double kUsual = 1 / 3.0;
      thing.theta = thing.prior = {ray.x(), ray.y(), kUsual};
      thing.information(2, 2) = 1 / (kUsual * kUsual);
      if (i < setting.known && !set_known(place, 1e-4 * Eigen::Matrix3d::Identity(), &thing)) continue;
      places_.push_back(place);
      p.things.push_back(thing);
    }
    return p;
  }
  double worst_turn_rad(const std::vector<Rigid3>& poses) const {
    double worst = 0;
    for (std::size_t k = 0; k < poses.size(); ++k) {
      worst = std::max(worst, poses[k].rotation.angularDistance(truth_[k].rotation));
    }
    return worst;
  }
  double worst_place(const std::vector<Rigid3>& poses) const {
    double worst = 0;
    for (std::size_t k = 0; k < poses.size(); ++k) {
      worst = std::max(worst, (poses[k].center() - truth_[k].center()).norm());
    }
    return worst;
  }

  const CameraModel camera_ = test::sim_camera();
  std::vector<Rigid3> truth_;
  std::vector<Eigen::Vector3d> places_;
};

TEST_F(WindowSolve, FindsHowTheCameraWentWithoutAKnownPlace) {
  const WindowProblem p = make({});
  const WindowResult r = solve_window(p);
  EXPECT_GT(worst_turn_rad(p.cam_from_world), 0.02);
  EXPECT_LT(worst_turn_rad(r.cam_from_world), 0.003);
  EXPECT_LT(worst_place(r.cam_from_world), 0.03);
  for (int k = 0; k < kFixed; ++k) EXPECT_THAT(r.cam_from_world[k], PoseNear(truth_[k], 1e-12, 1e-12));
  EXPECT_LT(r.cost, 0.1 * r.cost_before);
}

TEST_F(WindowSolve, KnownPlacesHoldIt) {
  const WindowResult r = solve_window(make({.known = 60}));
  EXPECT_LT(worst_turn_rad(r.cam_from_world), 0.002);
  EXPECT_LT(worst_place(r.cam_from_world), 0.01);
}

TEST_F(WindowSolve, StandsWrongObservations) {
  const WindowResult r = solve_window(make({.outliers = 0.1}));
  EXPECT_LT(worst_turn_rad(r.cam_from_world), 0.004);
  EXPECT_LT(worst_place(r.cam_from_world), 0.04);
}

TEST_F(WindowSolve, ThingsAtInfinityTellTheTurn) {
  const WindowProblem p = make({.at_infinity = true});
  const WindowResult r = solve_window(p);
  EXPECT_LT(worst_turn_rad(r.cam_from_world), 0.003);
  std::vector<double> inverse_depths;
  for (const Eigen::Vector3d& theta : r.theta) {
    EXPECT_GE(theta.z(), 0);
    inverse_depths.push_back(theta.z());
  }
  std::ranges::sort(inverse_depths);
  EXPECT_LT(inverse_depths[inverse_depths.size() / 2], 0.2) << "it began at a third";
}

TEST_F(WindowSolve, ItsSolutionIsAMinimum) {
  WindowProblem p = make({.outliers = 0.05});
  const WindowResult r = solve_window(p, 200);
  p.cam_from_world = r.cam_from_world;
  for (std::size_t i = 0; i < p.things.size(); ++i) p.things[i].theta = r.theta[i];
  const auto cost_at = [&](const WindowProblem& of) { return solve_window(of, 0).cost; };
  const double here = cost_at(p);
  EXPECT_NEAR(here, r.cost, 1e-9 * here);
  for (int k = kFixed; k < kPoses; k += 3) {
    for (int i = 0; i < 6; ++i) {
      WindowProblem beside = p;
      Vector6d step = Vector6d::Zero();
      step[i] = i < 3 ? 1e-3 : 1e-2;
      beside.cam_from_world[static_cast<std::size_t>(k)] = retract(p.cam_from_world[static_cast<std::size_t>(k)], step);
      const double more = cost_at(beside) - here;
      beside.cam_from_world[static_cast<std::size_t>(k)] =
          retract(p.cam_from_world[static_cast<std::size_t>(k)], -step);
      const double less = cost_at(beside) - here;
      EXPECT_GT(more, 0) << k << " " << i;
      EXPECT_GT(less, 0) << k << " " << i;
      EXPECT_LT(std::abs(more - less), 0.1 * (more + less)) << "its slope there is next to none: " << k << " " << i;
    }
  }
}

TEST(SetKnown, ThePriorIsThePlace) {
  WindowThing thing;
  thing.frame_from_world = Rigid3(so3_exp({0.1, -0.2, 0.3}), {0.5, -0.2, 0.1});
  const Eigen::Vector3d place = thing.frame_from_world.inverse() * Eigen::Vector3d(0.4, -0.6, 2);
  Eigen::Matrix3d covariance;
  covariance << 4e-4, 1e-4, 0, 1e-4, 9e-4, -2e-4, 0, -2e-4, 1e-3;
  ASSERT_TRUE(set_known(place, covariance, &thing));
  EXPECT_LT((thing.prior - Eigen::Vector3d(0.2, -0.3, 0.5)).norm(), 1e-12);
  EXPECT_EQ(thing.theta, thing.prior);
  // Numerically: how theta moves with the place.
  Eigen::Matrix3d j;
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 3; ++i) {
    WindowThing moved = thing;
    ASSERT_TRUE(set_known(place + kStep * Eigen::Vector3d::Unit(i), covariance, &moved));
    j.col(i) = (moved.theta - thing.theta) / kStep;
  }
  const Eigen::Matrix3d identity = thing.information * (j * covariance * j.transpose());
  EXPECT_LT((identity - Eigen::Matrix3d::Identity()).norm(), 1e-3);
}

TEST(SetKnown, WhatIsBehindIsRefused) {
  WindowThing thing;
  EXPECT_FALSE(set_known({0, 0, -1}, Eigen::Matrix3d::Identity(), &thing));
}

TEST(PlaceOf, IsTheSameInEveryFrame) {
  const Rigid3 frame(so3_exp({0.1, -0.2, 0.3}), {0.5, -0.2, 0.1});
  for (const Eigen::Vector3d& theta : {Eigen::Vector3d(0.2, -0.3, 0.5), Eigen::Vector3d(0.2, -0.3, 0)}) {
    const Eigen::Vector4d place = place_of(frame, theta);
    WindowThing same, other;
    same.frame_from_world = frame;
    set_start(place, &same);
    EXPECT_LT((same.theta - theta).norm(), 1e-12);
    other.frame_from_world = Rigid3(so3_exp({-0.1, 0.2, 0.1}), {1, 0, 0.4});
    set_start(place, &other);
    EXPECT_LT((place_of(other.frame_from_world, other.theta).normalized() - place.normalized()).norm(), 1e-12);
  }
}

TEST(PlaceOf, WhatIsBehindIsNoStart) {
  WindowThing thing;
  thing.theta = {0.1, 0.2, 0.3};
  set_start({0, 0, -1, 0}, &thing);
  EXPECT_EQ(thing.theta, Eigen::Vector3d(0.1, 0.2, 0.3));
}

}  // namespace
}  // namespace coslam::window_test
