// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/relative_pose.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <optional>
#include <random>
#include <vector>

#include "tests/support/matchers.h"
#include "tests/support/sim_world.h"

namespace coslam::relative_pose_test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::PoseNear;

struct Scene {
  int points = 120;
  double near_m = 3, far_m = 8;
  double part = 1;  // of the width of the image, in which the first image has them
  double noise_px = 0.5;
  double wrong = 0;  // share of the matches
};

class RelativePoseTest : public testing::Test {
 protected:
  // Matches of feature i with feature i.
  void look(const Rigid3& second_from_first, const Scene& scene) {
    truth_ = second_from_first;
    images_.assign(2, FeatureImage{.camera = test::sim_camera()});
    matches_.clear();
    wrong_.clear();
    const CameraModel& camera = images_[0].camera;
    while (static_cast<int>(matches_.size()) < scene.points) {
      const Vector2d px(scene.part * uniform(0, camera.width_px - 1), scene.part * uniform(0, camera.height_px - 1));
      const Vector3d p = uniform(scene.near_m, scene.far_m) * camera.normalized_from_pixel(px).homogeneous();
      const Vector3d in_second = second_from_first * p;
      if (in_second.z() < 0.1 || !camera.contains_raw(camera.project(in_second))) continue;
      wrong_.push_back(uniform(0, 1) < scene.wrong);
      const Vector2d elsewhere(uniform(0, camera.width_px - 1), uniform(0, camera.height_px - 1));
      const Vector2d seen = wrong_.back() ? elsewhere : camera.project(in_second);
      const int i = static_cast<int>(matches_.size());
      images_[0].undistorted_px.push_back(px + noise(scene.noise_px));
      images_[1].undistorted_px.push_back(seen + noise(scene.noise_px));
      matches_.push_back({i, i, 0});
    }
  }
  void tie(const Rigid3& second_from_first) {
    images_[0].rig = images_[1].rig = "left";
    images_[1].cam_from_rig = second_from_first;
  }
  std::optional<RelativePose> solve() const { return relative_pose(images_, 0, 1, matches_, config_); }
  Rigid3 truth_of_length_1() const { return {truth_.rotation, truth_.translation.normalized()}; }
  double uniform(double low, double high) { return std::uniform_real_distribution<>(low, high)(random_); }
  Vector2d noise(double sigma) { return sigma * Vector2d(normal_(random_), normal_(random_)); }

  const StartConfig config_;
  const Rigid3 aside_{so3_exp({0.02, 0.1, -0.03}), {-0.8, 0.1, 0.2}};
  Rigid3 truth_;
  std::vector<FeatureImage> images_;
  std::vector<FeatureMatch> matches_;
  std::vector<bool> wrong_;
  std::mt19937_64 random_{7};
  std::normal_distribution<double> normal_;
};

TEST_F(RelativePoseTest, IsFoundThroughNoiseAndWrongMatches) {
  look(aside_, {.wrong = 0.3});
  const auto pair = solve();
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->first, 0);
  EXPECT_EQ(pair->second, 1);
  EXPECT_FALSE(pair->metric);
  EXPECT_THAT(pair->second_from_first, PoseNear(truth_of_length_1(), 0.01, 0.06));
  const auto right = std::ranges::count(wrong_, false);
  EXPECT_GT(static_cast<double>(pair->inliers.size()), 0.85 * static_cast<double>(right));
  const auto wrong = std::ranges::count_if(
      pair->inliers, [&](const FeatureMatch& m) { return wrong_[static_cast<std::size_t>(m.first)]; });
  EXPECT_LE(wrong, 4) << "those that happen to lie on their line";
  EXPECT_GT(pair->median_parallax_rad, 0.1);
  EXPECT_LT(pair->median_parallax_rad, 0.25) << "0.8 m at 3 to 8 m";
}

TEST_F(RelativePoseTest, TheOrderOfTheImagesIsThatOfThePair) {
  look(aside_, {});
  const auto back = relative_pose(images_, 1, 0, matches_, config_);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->first, 1);
  EXPECT_EQ(back->second, 0);
  EXPECT_THAT(back->second_from_first.inverse(), PoseNear(truth_of_length_1(), 0.01, 0.06));
}

TEST_F(RelativePoseTest, TooFewMatchesAreNone) {
  look(aside_, {.points = config_.min_matches - 1, .noise_px = 0});
  EXPECT_FALSE(solve());
  look(aside_, {.points = config_.min_matches, .noise_px = 0});
  EXPECT_TRUE(solve());
  matches_.clear();
  EXPECT_FALSE(solve());
}

TEST_F(RelativePoseTest, TooLittleParallaxIsNone) {
  look({aside_.rotation, 0.02 * aside_.translation}, {.noise_px = 0.1});
  EXPECT_FALSE(solve());
  look({aside_.rotation, Vector3d::Zero()}, {});
  EXPECT_FALSE(solve()) << "a turn alone";
}

TEST_F(RelativePoseTest, ARigIsTakenAsItIsAndInMetres) {
  const Rigid3 rig{so3_exp({0, 0.02, 0}), {-0.3, 0, 0}};
  look(rig, {.wrong = 0.3});
  tie(rig);
  const auto pair = solve();
  ASSERT_TRUE(pair);
  EXPECT_TRUE(pair->metric);
  EXPECT_EQ(pair->second_from_first.translation, rig.translation) << "to the bit";
  EXPECT_GT(pair->inliers.size(), 70U);
}

TEST_F(RelativePoseTest, ARigSeesFarThingsWithLittleParallax) {
  const Rigid3 rig{so3_exp({0, 0.02, 0}), {-0.3, 0, 0}};
  look(rig, {.near_m = 60, .far_m = 200});
  EXPECT_FALSE(solve()) << "without a rig";
  tie(rig);
  const auto pair = solve();
  ASSERT_TRUE(pair);
  EXPECT_TRUE(pair->metric);
  EXPECT_LT(pair->median_parallax_rad, config_.min_parallax_rad);
}

TEST_F(RelativePoseTest, ARigThatTheImagesContradictIsLeftAside) {
  look(aside_, {});
  for (const Rigid3& wrong : {aside_.inverse(), Rigid3{so3_exp({0, 0, 1.5}), aside_.translation},
                              Rigid3{aside_.rotation, -aside_.translation}}) {
    tie(wrong);
    const auto pair = solve();
    ASSERT_TRUE(pair);
    EXPECT_FALSE(pair->metric);
    EXPECT_THAT(pair->second_from_first, PoseNear(truth_of_length_1(), 0.01, 0.06));
  }
}

TEST_F(RelativePoseTest, ManySpreadMatchesWithParallaxMakeTheBestPair) {
  const auto score = [&](const Rigid3& second_from_first, const Scene& scene) {
    look(second_from_first, scene);
    const auto pair = solve();
    return pair ? pair->score : 0;
  };
  const double all = score(aside_, {});
  EXPECT_GT(all, 1.5 * score(aside_, {.points = 60})) << "half as many";
  EXPECT_GT(all, 1.3 * score(aside_, {.part = 0.5})) << "in a part of the image";
  EXPECT_GT(all, 1.5 * score({aside_.rotation, 0.3 * aside_.translation}, {})) << "less parallax";
}

}  // namespace
}  // namespace coslam::relative_pose_test
