// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/trajectories.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "deploy/coslam/eval/statistics.h"

namespace coslam::eval::trajectories_test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// A camera at a place, looking along z, turned about y.
Rigid3 camera_at(const Eigen::Vector3d& center, double yaw_rad = 0) {
  return Rigid3(so3_exp({0, yaw_rad, 0}), center).inverse();
}

// The same camera in a map that truth_from_map takes to the truth.
Rigid3 in_map(const Rigid3& cam_from_truth, const Similarity3& truth_from_map) {
  return transform_world(cam_from_truth, truth_from_map.inverse());
}

const Similarity3 kTruthFromMap{0.5, so3_exp({0.2, 1.0, -0.4}), {3, -1, 2}};

// A half circle of radius 4, one pose each 0.1 s.
PosePairs half_circle(const Similarity3& truth_from_map, double turn = std::numbers::pi) {
  PosePairs pairs;
  for (int i = 0; i <= 100; ++i) {
    const double angle = turn * i / 100;
    const Rigid3 truth = camera_at({4 * std::cos(angle), 0.1 * std::sin(3 * angle), 4 * std::sin(angle)}, angle);
    pairs.push_back({i * 100'000'000LL, in_map(truth, truth_from_map), truth});
  }
  return pairs;
}

TEST(Statistics, PercentilesAndMeans) {
  EXPECT_EQ(percentile({3, 1, 2}, 50), 2);
  EXPECT_EQ(percentile({0, 10}, 90), 9);
  EXPECT_EQ(percentile({}, 50), 0);
  EXPECT_EQ(percentile({4}, 90), 4);
  EXPECT_DOUBLE_EQ(root_mean_square({3, 4}), std::sqrt(12.5));
}

TEST(PairPoses, TakesTheTruthAtTheStamp) {
  const Trajectory truth = {{0, camera_at({0, 0, 0})}, {100, camera_at({1, 0, 0})}};
  const Trajectory estimate = {{-2'000'000, {}}, {50, {}}, {100 + 900'000, {}}, {100 + 2'000'000, {}}};
  const auto pairs = pair_poses(estimate, truth, 200);
  ASSERT_EQ(pairs.size(), 2u);  // stamps may be rounded by less than a millisecond at the ends
  EXPECT_NEAR(pairs[0].truth.center().x(), 0.5, 1e-12);
  EXPECT_NEAR(pairs[1].truth.center().x(), 1, 1e-12);
  EXPECT_TRUE(pair_poses(estimate, {}, 200).empty());
}

TEST(Ate, OneSimilarityForAllAgents) {
  // By hand: two agents whose corners form a square of side 2 in truth. The map is the truth halved, except that all
  // points of agent b are shifted by 2 d along z, +, -, -, +: orthogonal to the square and balanced against every
  // motion of it, so the best similarity stays the plain doubling. Error: a 0, b 2 d, joint sqrt((4 * 0 + 4 * 4 d^2) /
  // 8) = sqrt(2) d.
  const double d = 0.01;
  PosePairs a, b;
  const std::vector<Eigen::Vector3d> corners = {{1, 1, 0}, {1, -1, 0}, {-1, 1, 0}, {-1, -1, 0}};
  const std::vector<double> lift = {1, -1, -1, 1};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto t_ns = static_cast<TimeNs>(i);
    a.push_back({t_ns, camera_at(0.5 * corners[i]), camera_at(corners[i])});
    b.push_back({t_ns, camera_at(0.5 * corners[i] + Eigen::Vector3d(0, 0, d * lift[i])), camera_at(corners[i])});
  }
  const Alignment joint = align_centers({a, b});
  ASSERT_TRUE(joint.target_from_source);
  // The lifts make the map a little larger, which shrinks the scale in second order.
  EXPECT_NEAR(joint.target_from_source->scale, 2, 1e-3);
  EXPECT_NEAR(joint.rmse, std::sqrt(2.0) * d, 1e-5);
  EXPECT_NEAR(*position_rmse(a, *joint.target_from_source), 0, 1e-3);
  EXPECT_NEAR(*position_rmse(b, *joint.target_from_source), 2 * d, 1e-4);
}

TEST(Ate, AgentsThatDisagreeShowOnlyJointly) {
  // Each agent is perfect alone; b's map is shifted by 0.3 against a's. The similarity splits the difference at best.
  const PosePairs a = half_circle(kTruthFromMap);
  PosePairs b = a;
  for (PosePair& pair : b)
    pair.estimate = transform_world(pair.estimate, {1, Eigen::Quaterniond::Identity(), {0.6, 0, 0}});
  EXPECT_LT(align_centers({a}).rmse, 1e-9);
  EXPECT_LT(align_centers({b}).rmse, 1e-9);
  EXPECT_NEAR(align_centers({a, b}).rmse, 0.15, 0.01);  // 0.6 map units are 0.3 m
}

TEST(Ate, NothingToAlign) {
  EXPECT_FALSE(align_centers({}).target_from_source);
  EXPECT_FALSE(align_centers({{}}).target_from_source);
  EXPECT_EQ(position_rmse({}, {}), std::nullopt);
}

TEST(WorstFrame, IsTheFarthestBesideTheOthers) {
  PosePairs pairs;
  for (int i = 0; i < 9; ++i) {
    const double off_m = i == 6 ? 0.5 : 0.1;
    pairs.push_back({i * to_ns(0.1), camera_at({i + off_m, 0, 0}), camera_at({1.0 * i, 0, 0})});
  }
  const auto worst = worst_frame(pairs, {});
  ASSERT_TRUE(worst);
  EXPECT_NEAR(worst->error_m, 0.5, 1e-9);
  EXPECT_NEAR(worst->median_m, 0.1, 1e-9);
  EXPECT_EQ(worst->t_ns, 6 * to_ns(0.1));
  EXPECT_FALSE(worst_frame({}, {}));
}

TEST(PathLength, SumsTheSteps) {
  EXPECT_EQ(path_length({}), 0);
  EXPECT_NEAR(path_length({{0, camera_at({0, 0, 0}, 1)}, {1, camera_at({3, 0, 4}, 2)}, {2, camera_at({3, 1, 4})}}), 6,
              1e-12);
}

TEST(MotionError, IsZeroForAPerfectPath) {
  const auto error = motion_error({half_circle(kTruthFromMap)}, kTruthFromMap.scale, 1'000'000'000);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->count, 91);
  EXPECT_LT(error->translation_rmse_m, 1e-9);
  EXPECT_LT(error->rotation_rmse_deg, 1e-6);
}

TEST(MotionError, MeasuresDriftPerSecond) {
  PosePairs fast, turning;  // 1 m/s along x; one estimate is 2 % too fast, the other turns by half a degree a second
  for (int i = 0; i <= 40; ++i) {
    const double t_s = 0.1 * i;
    const Rigid3 truth = camera_at({t_s, 0, 0});
    fast.push_back({to_ns(t_s), camera_at({1.02 * t_s, 0, 0}), truth});
    turning.push_back({to_ns(t_s), camera_at({t_s, 0, 0}, 0.5 * kDegree * t_s), truth});
  }
  const auto translation = motion_error({fast}, 1, 1'000'000'000);
  ASSERT_TRUE(translation);
  EXPECT_EQ(translation->count, 31);
  EXPECT_NEAR(translation->translation_rmse_m, 0.02, 1e-9);
  EXPECT_NEAR(translation->rotation_rmse_deg, 0, 1e-9);
  EXPECT_NEAR(motion_error({fast}, 1 / 1.02, 1'000'000'000)->translation_rmse_m, 0, 1e-9);
  const auto rotation = motion_error({turning}, 1, 1'000'000'000);
  EXPECT_NEAR(rotation->rotation_rmse_deg, 0.5, 1e-6);
  EXPECT_NEAR(rotation->rotation_median_deg, 0.5, 1e-6);
  EXPECT_FALSE(motion_error({fast}, 1, 10'000'000'000));  // longer than the path
}

TEST(Drift, OnlyWhereThePathCloses) {
  EXPECT_EQ(closing_drift(half_circle(kTruthFromMap), kTruthFromMap), std::nullopt);
  PosePairs loop = half_circle(kTruthFromMap, 2 * std::numbers::pi);
  EXPECT_NEAR(closing_drift(loop, kTruthFromMap).value_or(1), 0, 1e-9);
  loop.back().estimate = transform_world(loop.back().estimate, {1, Eigen::Quaterniond::Identity(), {0, 0.2, 0}});
  EXPECT_NEAR(closing_drift(loop, kTruthFromMap).value_or(1), 0.1, 1e-9);  // half a metre a map unit
  EXPECT_EQ(closing_drift({}, {}), std::nullopt);
}

TEST(RelativePose, NeedsNoAlignment) {
  // b stands 0.12 to the right of a; the map is metric but for 2 % and b is turned by one degree.
  const PosePairs a = half_circle({1, kTruthFromMap.rotation, kTruthFromMap.translation});
  PosePairs b;
  for (const PosePair& pair : a) {
    const Rigid3 true_b_from_a{Eigen::Quaterniond::Identity(), {-0.12, 0, 0}};
    const Rigid3 b_from_a{so3_exp({0, kDegree, 0}), {-0.12 * 1.02, 0, 0}};
    b.push_back({pair.t_ns + 1000, b_from_a * pair.estimate, true_b_from_a * pair.truth});
  }
  const auto error = relative_pose_error(a, b, 1 / 1.02);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->count, 101);
  EXPECT_NEAR(error->translation, 0.0024, 1e-9);
  EXPECT_NEAR(error->translation_scaled, 0, 1e-9);
  EXPECT_NEAR(error->rotation_deg, 1, 1e-6);
  EXPECT_NEAR(error->baseline_m, 0.12, 1e-9);
  for (PosePair& pair : b) pair.t_ns += 50'000'000;
  EXPECT_FALSE(relative_pose_error(a, b, 1));  // no common times
}

}  // namespace
}  // namespace coslam::eval::trajectories_test
