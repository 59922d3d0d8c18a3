// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/two_view.h"

#include <gtest/gtest.h>

#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "tests/support/matchers.h"

namespace coslam::two_view_test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::PoseNear;

constexpr double kNoise = 0.5 / 460, kThreshold = 3 * kNoise;  // half a pixel

enum class Place { kRoom, kPlane };

// What two cameras see of points in front of both; the last `wrong` matches are of nothing.
class TwoViews {
 public:
  TwoViews(Place place, const Rigid3& second_from_first, int points, int wrong = 0) : points_(points) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> across(-0.55, 0.55), depth(3, 8);
    std::normal_distribution<double> noise(0, kNoise);
    const auto seen = [&](const Vector3d& p) -> Vector2d {
      return p.hnormalized() + Vector2d(noise(random), noise(random));
    };
    for (int i = 0; i < points + wrong; ++i) {
      const Vector2d at(across(random), across(random));
      const double away = depth(random), on_wall = 5 / (1 - 0.5 * at.x());
      const Vector3d p = (place == Place::kPlane ? on_wall : away) * at.homogeneous();
      first.push_back(seen(p));
      second.push_back(i < points ? seen(second_from_first * p) : Vector2d(across(random), across(random)));
    }
  }
  std::optional<TwoViewMotion> motion() const { return two_view_motion(first, second, kThreshold); }
  // How many of the right and of the wrong matches fit.
  std::pair<int, int> fitting(const TwoViewMotion& m) const {
    std::pair<int, int> out;
    for (std::size_t i = 0; i < m.fits.size(); ++i) {
      (i < static_cast<std::size_t>(points_) ? out.first : out.second) += m.fits[i] ? 1 : 0;
    }
    return out;
  }

  std::vector<Vector2d> first, second;

 private:
  int points_;
};

Rigid3 sideways() { return {so3_exp({0.02, -0.08, 0.03}), {-0.9, 0.05, 0.1}}; }

// The length of the way is not to be told.
Rigid3 unit(Rigid3 motion) {
  motion.translation.normalize();
  return motion;
}

TEST(TwoViewMotion, IsFoundAmongPointsInSpace) {
  const TwoViews views(Place::kRoom, sideways(), 150);
  const auto found = views.motion();
  ASSERT_TRUE(found.has_value());
  EXPECT_THAT(found->second_from_first, PoseNear(unit(sideways()), 0.03, 0.005));
  EXPECT_GE(found->support, 140);
}

TEST(TwoViewMotion, IsFoundAmongPointsOfOnePlane) {
  const TwoViews views(Place::kPlane, sideways(), 150);
  const auto found = views.motion();
  ASSERT_TRUE(found.has_value());
  EXPECT_THAT(found->second_from_first, PoseNear(unit(sideways()), 0.05, 0.02));
}

TEST(TwoViewMotion, IsFoundForwards) {
  const Rigid3 ahead(so3_exp({0.01, 0.02, 0}), {0.05, 0, -0.8});
  const auto found = TwoViews(Place::kRoom, ahead, 150).motion();
  ASSERT_TRUE(found.has_value());
  EXPECT_THAT(found->second_from_first, PoseNear(unit(ahead), 0.05, 0.01));
}

TEST(TwoViewMotion, AThirdOfWrongMatchesDoesNotMatter) {
  const TwoViews views(Place::kRoom, sideways(), 100, 50);
  const auto found = views.motion();
  ASSERT_TRUE(found.has_value());
  EXPECT_THAT(found->second_from_first, PoseNear(unit(sideways()), 0.05, 0.01));
  const auto [right, wrong] = views.fitting(*found);
  EXPECT_GE(right, 93);
  EXPECT_LE(wrong, 8) << "by chance on their epipolar lines";
}

// Two cameras of a car look down a street through low, wide images: most matches are right to a seventh of a pixel,
// some lie on what moves, a pixel or three off and inside the threshold.
TEST(TwoViewMotion, AFewThatAreNearlyRightDoNotBendIt) {
  constexpr double kFocal_px = 700, kNoise_px = 0.15, kThreshold_px = 3.8, kBaseline_m = 0.54;
  const Rigid3 aside(Eigen::Quaterniond::Identity(), {-kBaseline_m, 0, 0});
  for (unsigned seed = 1; seed <= 10; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> across(-0.85, 0.85), down(-0.25, 0.25), depth_m(8, 30), off_px(1, 3);
    std::normal_distribution<double> noise_px(0, kNoise_px);
    std::vector<Vector2d> first, second;
    for (int i = 0; i < 100; ++i) {
      const Vector3d p = depth_m(random) * Vector2d(across(random), down(random)).homogeneous();
      const double moved_px = i < 15 ? off_px(random) : 0;
      first.emplace_back(p.hnormalized() + Vector2d(noise_px(random), noise_px(random)) / kFocal_px);
      second.emplace_back((aside * p).hnormalized() +
                          Vector2d(noise_px(random), noise_px(random) + moved_px) / kFocal_px);
    }
    const auto found = two_view_motion(first, second, kThreshold_px / kFocal_px);
    ASSERT_TRUE(found.has_value()) << seed;
    EXPECT_THAT(found->second_from_first, PoseNear(unit(aside), 0.002, 0.015)) << seed;
  }
}

TEST(TwoViewMotion, ThereIsNoneWhereATurnExplainsAll) {
  EXPECT_FALSE(TwoViews(Place::kRoom, {so3_exp({0.03, 0.12, -0.02}), Vector3d::Zero()}, 150).motion().has_value());
}

TEST(TwoViewMotion, MatchesOfNothingHaveLittleSupport) {
  const auto found = TwoViews(Place::kRoom, sideways(), 0, 100).motion();
  EXPECT_LT(found ? found->support : 0, 20);
}

TEST(TwoViewMotion, ThereIsNoneOfTooFew) {
  EXPECT_FALSE(two_view_motion({}, {}, kThreshold).has_value());
  EXPECT_FALSE(TwoViews(Place::kRoom, sideways(), 4).motion().has_value());
}

}  // namespace
}  // namespace coslam::two_view_test
