// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/pose_graph.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/matchers.h"

namespace coslam::pose_graph_test {
namespace {

using test::PoseNear;

// A camera that looks along its way on a circle of 4 m, once around.
Rigid3 on_circle(double turn) {
  const double a = 2 * std::numbers::pi * turn;
  const Eigen::Quaterniond world_from_cam = so3_exp({0, a, 0});
  const Eigen::Vector3d center(4 - 4 * std::cos(a), 0.2 * std::sin(3 * a), 4 * std::sin(a));
  return {world_from_cam.conjugate(), -(world_from_cam.conjugate() * center)};
}

// The same path as somebody measures it who errs a little at every step, and whose unit of length shrinks as he goes.
std::vector<Rigid3> drifted(const std::vector<Rigid3>& truth, double turn_rad, double shrink) {
  std::vector<Rigid3> out{truth.front()};
  double scale = 1;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    Rigid3 step = truth[i] * truth[i - 1].inverse();
    scale *= shrink;
    step.translation *= scale;
    out.push_back(retract(step, (Vector6d() << turn_rad, -turn_rad, turn_rad, 0, 0, 0).finished()) * out.back());
  }
  return out;
}

std::vector<Rigid3> circle(int frames) {
  std::vector<Rigid3> out;
  for (int i = 0; i < frames; ++i) out.push_back(on_circle(static_cast<double>(i) / (frames - 1)));
  return out;
}

double worst(const PoseGraphSolution& s, const std::vector<Rigid3>& truth, std::size_t first_node = 0) {
  double out = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    out = std::max(out, (s.nodes[first_node + i].cam_from_world.center() - truth[i].center()).norm());
  }
  return out;
}

PoseGraph path_of(const std::vector<Rigid3>& poses) {
  PoseGraph g;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    g.nodes.push_back({poses[i], i == 0});
    if (i > 0) g.links.push_back({static_cast<int>(i) - 1, static_cast<int>(i), 1});
  }
  return g;
}

TEST(PoseGraph, NothingMovesWhenAllAgrees) {
  const auto truth = circle(60);
  PoseGraph g = path_of(truth);
  g.ties.push_back({59, 0, truth[59] * truth[0].inverse(), 1});
  const PoseGraphSolution s = solve_path_graph(g);
  ASSERT_TRUE(s.ok);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_THAT(s.nodes[i].cam_from_world, PoseNear(truth[i], 1e-6, 1e-6));
    EXPECT_NEAR(s.nodes[i].scale, 1, 1e-9);
  }
}

TEST(PoseGraph, ATieHoldsExactlyAndTheDriftIsSpread) {
  const auto truth = circle(200);
  const auto measured = drifted(truth, 2e-4, 1.0);
  const double before = (measured.back().center() - truth.back().center()).norm();
  ASSERT_GT(before, 0.1);
  PoseGraph g = path_of(measured);
  const Rigid3 last_from_first = truth.back() * truth.front().inverse();
  g.ties.push_back({199, 0, last_from_first, 1});
  const PoseGraphSolution s = solve_path_graph(g);
  ASSERT_TRUE(s.ok);
  EXPECT_THAT(s.nodes[199].cam_from_world * s.nodes[0].cam_from_world.inverse(), PoseNear(last_from_first, 1e-9, 1e-9));
  EXPECT_LT(worst(s, truth), 0.4 * before);
  EXPECT_THAT(s.nodes[0].cam_from_world, PoseNear(truth[0], 1e-12, 1e-12)) << "the first is fixed";
}

TEST(PoseGraph, ScaleDriftIsTakenBack) {
  const auto truth = circle(200);
  const double shrink = std::pow(0.9, 1.0 / 199);
  const auto measured = drifted(truth, 0, shrink);
  PoseGraph g = path_of(measured);
  g.ties.push_back({199, 0, truth.back() * truth.front().inverse(), 1 / 0.9});
  const PoseGraphSolution s = solve_path_graph(g);
  ASSERT_TRUE(s.ok);
  EXPECT_NEAR(s.nodes[199].scale, 1 / 0.9, 1e-9);
  EXPECT_NEAR(s.nodes[100].scale, std::pow(1 / 0.9, 100.0 / 199), 1e-3);
  EXPECT_LT(worst(s, truth), 0.01);
  // Things seen by a camera keep their place in its image.
  const Eigen::Vector3d in_cam(0.5, -0.2, 3);
  const Eigen::Vector3d moved = s.nodes[150].new_from_old * (measured[150].inverse() * in_cam);
  EXPECT_LT((s.nodes[150].cam_from_world * moved - s.nodes[150].scale * in_cam).norm(), 1e-9);
}

// Two cameras part, drift differently, and one sees the place where the other stands; a third flies with the first.
TEST(PoseGraph, TwoGroupsMeetAndBothGiveWay) {
  const auto truth = circle(101);
  const std::vector<Rigid3> half(truth.begin(), truth.begin() + 51);
  std::vector<Rigid3> back;
  for (std::size_t i = 0; i < 51; ++i) back.push_back(truth[100 - i]);
  const auto a = drifted(half, 3e-4, 1.001), b = drifted(back, -3e-4, 0.999);
  const Rigid3 beside(Eigen::Quaterniond::Identity(), {0.5, 0, 0});
  PoseGraph g;
  for (const Rigid3& p : a) g.nodes.push_back({p, false});
  for (const Rigid3& p : b) g.nodes.push_back({p, false});
  for (const Rigid3& p : a) g.nodes.push_back({beside * p, false});
  for (int n : {0, 51, 102}) g.nodes[static_cast<std::size_t>(n)].fixed = true;
  for (int start : {0, 51, 102}) {
    for (int i = 1; i < 51; ++i) g.links.push_back({start + i - 1, start + i, 1});
  }
  for (int i = 1; i < 51; i += 5) g.links.push_back({i, 102 + i, 1});
  const double scale_a = std::pow(1.001, 50), scale_b = std::pow(0.999, 50);
  Rigid3 b_from_a = back[50] * half[50].inverse();
  b_from_a.translation *= scale_b;  // as b measures it
  g.ties.push_back({50, 101, b_from_a.inverse(), scale_b / scale_a});
  g.ties.push_back({152, 50, beside, 1});
  const PoseGraphSolution s = solve_path_graph(g);
  ASSERT_TRUE(s.ok);
  const double before =
      (a.back().center() - half.back().center()).norm() + (b.back().center() - back.back().center()).norm();
  EXPECT_LT(worst(s, half), 0.4 * before);
  EXPECT_LT(worst(s, back, 51), 0.4 * before);
  EXPECT_NEAR(s.nodes[50].scale / s.nodes[101].scale, scale_b / scale_a, 1e-9);
  EXPECT_NEAR((s.nodes[152].cam_from_world.center() - s.nodes[50].cam_from_world.center()).norm(),
              0.5 * s.nodes[50].scale, 1e-9)
      << "hard: cameras of a group keep how they see each other";
}

}  // namespace
}  // namespace coslam::pose_graph_test
