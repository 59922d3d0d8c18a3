// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/alignment.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace coslam::alignment_test {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Points random_points(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-2, 2);
  Points points;
  for (int i = 0; i < count; ++i) points.emplace_back(uniform(random), uniform(random), uniform(random));
  return points;
}

Points mapped(const Similarity3& s, const Points& points) {
  Points out;
  for (const auto& p : points) out.push_back(s * p);
  return out;
}

const Similarity3 kSimilarity{2.5, so3_exp({0.3, -2.0, 0.7}), {5, -3, 100}};

TEST(Alignment, RecoversASimilarity) {
  const Points source = random_points(20, 1);
  const auto result = align_points(source, mapped(kSimilarity, source), AlignmentScale::kFree);
  ASSERT_TRUE(result.target_from_source);
  EXPECT_NEAR(result.target_from_source->scale, 2.5, 1e-12);
  EXPECT_LT(result.target_from_source->rotation.angularDistance(kSimilarity.rotation), 1e-12);
  EXPECT_LT((result.target_from_source->translation - kSimilarity.translation).norm(), 1e-11);
  EXPECT_LT(result.rmse, 1e-12);
  EXPECT_TRUE(result.rotation_unique);
}

TEST(Alignment, FixedScaleKeepsTheResidual) {
  // A unit cross stretched by two: with scale 1 each of the four arms is one off.
  const Points source = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  const auto result =
      align_points(source, mapped({2, Eigen::Quaterniond::Identity(), {7, 0, 0}}, source), AlignmentScale::kFixed);
  ASSERT_TRUE(result.target_from_source);
  EXPECT_EQ(result.target_from_source->scale, 1);
  EXPECT_NEAR(result.rmse, 1, 1e-12);
  EXPECT_NEAR(result.target_spread, 2, 1e-12);
}

TEST(Alignment, NeverReflects) {
  const Points source = random_points(10, 2);
  Points mirrored = source;
  for (auto& p : mirrored) p.z() = -p.z();
  const auto result = align_points(source, mirrored, AlignmentScale::kFree);
  ASSERT_TRUE(result.target_from_source);
  EXPECT_NEAR(result.target_from_source->rotation.toRotationMatrix().determinant(), 1, 1e-12);
  EXPECT_GT(result.rmse, 0.1);
}

TEST(Alignment, PlanarPointsAreEnough) {
  Points source = random_points(10, 3);
  for (auto& p : source) p.z() = 0;
  const auto result = align_points(source, mapped(kSimilarity, source), AlignmentScale::kFree);
  ASSERT_TRUE(result.target_from_source);
  EXPECT_TRUE(result.rotation_unique);
  EXPECT_LT(result.target_from_source->rotation.angularDistance(kSimilarity.rotation), 1e-7);
}

TEST(Alignment, ALineLeavesTheTurnAboutItOpen) {
  Points source;
  for (int i = 0; i < 5; ++i) source.emplace_back(i, 2 * i, -i);
  const auto result = align_points(source, mapped(kSimilarity, source), AlignmentScale::kFree);
  ASSERT_TRUE(result.target_from_source);
  EXPECT_FALSE(result.rotation_unique);
  EXPECT_LT(result.rmse, 1e-9);
}

TEST(Alignment, SaysWhyThereIsNone) {
  const Points two = random_points(2, 4), three = random_points(3, 4);
  const Points same(5, Eigen::Vector3d(1e3, 2e3, 3e3 + 0.1));
  Points broken = three;
  broken[1].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_STREQ(align_points(two, two, AlignmentScale::kFree).problem, "fewer than three pairs");
  EXPECT_STREQ(align_points(two, three, AlignmentScale::kFree).problem, "the point sets differ in size");
  EXPECT_STREQ(align_points(three, broken, AlignmentScale::kFree).problem, "a point is not finite");
  EXPECT_STREQ(align_points(same, random_points(5, 5), AlignmentScale::kFree).problem,
               "the points are all at one place");
  EXPECT_STREQ(align_points(random_points(5, 5), same, AlignmentScale::kFree).problem,
               "the points are all at one place");
}

}  // namespace
}  // namespace coslam::alignment_test
