// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include "common/model/track_frame.h"
#include "server/estimator/solve/matching.h"
#include "server/estimator/solve/pnp.h"
#include "server/estimator/solve/start.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_world.h"

// match_descriptors and place_camera.
namespace coslam::match_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

const test::SimWorld kWorld({.seed = 6, .points = 300});

// Descriptors of world points, each byte noised.
Bytes descriptors_of(const std::vector<int>& points, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, noise + 1e-9);
  Bytes out;
  for (const int p : points) {
    for (const auto byte : kWorld.descriptor(p)) {
      out.push_back(static_cast<std::uint8_t>(std::clamp(byte + normal(random), 0.0, 255.0)));
    }
  }
  return out;
}

std::vector<int> range(int begin, int end) {
  std::vector<int> out;
  for (int i = begin; i < end; ++i) out.push_back(i);
  return out;
}

TEST(MatchDescriptors, FindsWhatIsInBoth) {
  // 50 to 149 in both, in another order.
  std::vector<int> first = range(0, 150), second = range(50, 250);
  std::shuffle(second.begin(), second.end(), std::mt19937(1));
  const auto matches = match_descriptors(descriptors_of(first, 8, 2), descriptors_of(second, 8, 3));
  EXPECT_GE(matches.size(), 98U);
  std::set<int> used;
  for (const FeatureMatch& m : matches) {
    EXPECT_EQ(first[static_cast<std::size_t>(m.first)], second[static_cast<std::size_t>(m.second)]);
    EXPECT_TRUE(used.insert(m.second).second) << "one to one";
    EXPECT_GE(m.distance, -1e-5);
    EXPECT_LT(m.distance, 0.2);
  }
}

TEST(MatchDescriptors, NothingIsAlike) {
  EXPECT_LE(match_descriptors(descriptors_of(range(0, 150), 8, 2), descriptors_of(range(150, 300), 8, 3)).size(), 1U);
}

TEST(MatchDescriptors, ThingsThatComeTwiceAreAmbiguous) {
  std::vector<int> second = range(0, 100);
  for (int i = 0; i < 50; ++i) second.push_back(i);
  const auto matches = match_descriptors(descriptors_of(range(0, 100), 4, 2), descriptors_of(second, 4, 3));
  EXPECT_LE(matches.size(), 57U);  // noise sets a few of the fifty pairs apart
  EXPECT_GE(matches.size(), 49U);
  // And in the other direction: the test is mutual.
  EXPECT_LE(match_descriptors(descriptors_of(second, 4, 3), descriptors_of(range(0, 100), 4, 2)).size(), 57U);
}

TEST(MatchDescriptors, EmptyGivesNothing) {
  EXPECT_TRUE(match_descriptors({}, descriptors_of(range(0, 5), 0, 1)).empty());
  EXPECT_TRUE(match_descriptors(descriptors_of(range(0, 5), 0, 1), {}).empty());
}

TEST(MatchDescriptors, AnEmptyDescriptorMatchesNone) {
  const Bytes flat(kDescriptorBytes * 3, 0);
  EXPECT_TRUE(match_descriptors(flat, flat).empty());
}

// Correspondences of a known pose.
struct Correspondences {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector2d> px;
  std::vector<bool> wrong;
};

const Rigid3 kTruth = test::looking({0.7, -0.3, 0.4}, -0.15, 0.05);

Correspondences observe(int count, double wrong_share, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, 0.7);
  std::uniform_real_distribution<double> uniform(0, 1);
  const CameraModel camera = test::sim_camera();
  Correspondences out;
  for (int i = 0; i < kWorld.size() && static_cast<int>(out.points.size()) < count; ++i) {
    const Eigen::Vector3d x = kTruth * kWorld.position(i);
    if (x.z() < 0.5 || !camera.contains_raw(camera.project(x))) continue;
    out.points.push_back(kWorld.position(i));
    out.wrong.push_back(uniform(random) < wrong_share);
    out.px.push_back(out.wrong.back()
                         ? Eigen::Vector2d(640 * uniform(random), 480 * uniform(random))
                         : Eigen::Vector2d(camera.project(x) + Eigen::Vector2d(normal(random), normal(random))));
  }
  return out;
}

TEST(PlaceCamera, StandsHalfOfTheMatchesWrong) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Correspondences c = observe(100, 0.5, seed);
    const PnpResult r = solve_pnp(test::sim_camera(), c.points, c.px, 1.0, 20);
    ASSERT_TRUE(r.ok) << seed;
    EXPECT_THAT(r.cam_from_world, test::PoseNear(kTruth, 0.006, 0.03)) << seed;
    EXPECT_GE(r.inliers.size(), 35U);
    const auto wrong =
        std::count_if(r.inliers.begin(), r.inliers.end(), [&](int i) { return c.wrong[static_cast<std::size_t>(i)]; });
    EXPECT_LE(wrong, 1) << seed;
  }
}

TEST(PlaceCamera, NoPoseFromWrongMatches) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Correspondences c = observe(80, 1.0, seed);
    EXPECT_FALSE(solve_pnp(test::sim_camera(), c.points, c.px, 1.0, 15).ok) << seed;
  }
}

TEST(PlaceCamera, NoPoseFromTooFew) {
  const Correspondences c = observe(14, 0, 1);
  EXPECT_FALSE(solve_pnp(test::sim_camera(), c.points, c.px, 1.0, 15).ok);
  EXPECT_FALSE(solve_pnp(test::sim_camera(), {}, {}, 1.0, 15).ok);
}

TEST(PlaceCamera, TheSameTwice) {
  const Correspondences c = observe(100, 0.4, 3);
  const PnpResult a = solve_pnp(test::sim_camera(), c.points, c.px, 1.0, 20);
  const PnpResult b = solve_pnp(test::sim_camera(), c.points, c.px, 1.0, 20);
  EXPECT_EQ(a.inliers, b.inliers);
  EXPECT_EQ(a.cam_from_world.translation, b.cam_from_world.translation);
}

}  // namespace
}  // namespace coslam::match_test
