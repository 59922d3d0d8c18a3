// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "server/estimator/solve/matching.h"
#include "server/estimator/solve/pnp.h"
#include "server/estimator/solve/start.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"
#include "tests/support/sim_tracker.h"

// start_map and start_from_matches: the first map from images of one instant.
namespace coslam::start_map_test {
namespace {

using test::looking;
using test::PoseNear;

struct Images {
  std::vector<FeatureImage> images;
  std::vector<Rigid3> truth;
  std::vector<std::vector<int>> world_points;  // per image and feature
};

Images images_of(const test::SimWorld& world, const std::vector<Rigid3>& poses, double noise_px = 0.5, int most = 150) {
  Images out;
  out.truth = poses;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    test::SimTracker tracker(world, test::still_path(poses[i]), {.noise_px = noise_px, .max_tracks = most}, "cam",
                             RunId(20 + i));
    const TrackFrame f = tracker.observe(FrameId(0), 0);
    FeatureImage& image = out.images.emplace_back();
    image.camera = test::sim_camera();
    image.descriptors = tracker.describe(f).descriptors;
    std::vector<int>& of = out.world_points.emplace_back();
    for (const TrackObservation& o : f.tracks) {
      image.undistorted_px.emplace_back(o.undistorted_px.cast<double>());
      of.push_back(tracker.point_of(o.track));
    }
  }
  return out;
}

// Where an image must be: truth seen from image `first`, with its distance to `second` as the unit of length.
Rigid3 expected(const Images& in, const StartResult& r, std::size_t image) {
  const Rigid3 &a = in.truth[static_cast<std::size_t>(r.first)], &b = in.truth[static_cast<std::size_t>(r.second)];
  const double unit = (a.center() - b.center()).norm();
  const Similarity3 map_from_world{1 / unit, a.rotation, a.translation / unit};
  return transform_world(in.truth[image], map_from_world);
}

void expect_points(const test::SimWorld& world, const Images& in, const StartResult& r, double most) {
  const Rigid3 &a = in.truth[static_cast<std::size_t>(r.first)], &b = in.truth[static_cast<std::size_t>(r.second)];
  const double unit = (a.center() - b.center()).norm();
  std::vector<double> errors;
  for (const StartResult::Point& p : r.points) {
    ASSERT_GE(p.seen.size(), 2U);
    const auto [image, feature] = p.seen.front();
    const int point = in.world_points[static_cast<std::size_t>(image)][static_cast<std::size_t>(feature)];
    const Eigen::Vector3d truth = (a * world.position(point)) / unit;
    errors.push_back((p.position - truth).norm() / truth.norm());
    for (const auto& [other, f] : p.seen) {
      EXPECT_EQ(in.world_points[static_cast<std::size_t>(other)][static_cast<std::size_t>(f)], point);
    }
  }
  EXPECT_LT(test::median(errors), most);
}

const std::vector<Rigid3> kThree{looking({-0.9, 0, 0}, 0.05), looking({0, 0.1, 0.1}), looking({1.0, -0.1, 0}, -0.05)};

TEST(StartMap, ThreeImagesOfARoom) {
  const test::SimWorld world({});
  const Images in = images_of(world, kThree);
  const StartResult r = start_map(in.images, {});
  ASSERT_TRUE(r.ok) << r.reason;
  EXPECT_GT(r.points.size(), 80U);
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(r.cam_from_world[i]) << i;
    EXPECT_THAT(*r.cam_from_world[i], PoseNear(expected(in, r, i), 0.004, 0.02)) << i;
  }
  EXPECT_THAT(*r.cam_from_world[static_cast<std::size_t>(r.first)], PoseNear(Rigid3(), 1e-7, 1e-9));
  expect_points(world, in, r, 0.02);
}

TEST(StartMap, APlanarScene) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const test::SimWorld world({.seed = seed, .layout = test::Layout::kPlane, .points = 300});
    const Images in = images_of(world, kThree);
    const StartResult r = start_map(in.images, {});
    ASSERT_TRUE(r.ok) << r.reason;
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_TRUE(r.cam_from_world[i]) << i;
      EXPECT_THAT(*r.cam_from_world[i], PoseNear(expected(in, r, i), 0.01, 0.05)) << seed << ' ' << i;
    }
    expect_points(world, in, r, 0.03);
  }
}

// The mirrored motion of a plane explains the same matches, but puts part of them behind a camera.
TEST(StartMap, TwoViewsOfAPlane) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const test::SimWorld world({.seed = seed, .layout = test::Layout::kPlane, .points = 300});
    const Images in = images_of(world, {kThree[0], kThree[1]});
    const StartResult r = start_map(in.images, {});
    ASSERT_TRUE(r.ok) << seed << ' ' << r.reason;
    EXPECT_THAT(*r.cam_from_world[1], PoseNear(expected(in, r, 1), 0.01, 0.06)) << seed;
    EXPECT_GT(r.points.size(), 130U);
  }
}

// A small patch of a plane leaves both motions: no map is better than a mirrored one.
TEST(StartMap, AMirroredMapIsNeverGiven) {
  int refused = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const test::SimWorld world({.seed = seed, .layout = test::Layout::kPlane, .points = 2500});
    Images in = images_of(world, {looking({-0.5, 0, -1}), looking({0.46, 0, -0.28})}, 0.3, 1500);
    const auto small_part = [](FeatureImage* image, const Eigen::Vector2d& center_px) {
      FeatureImage part;
      part.camera = image->camera;
      for (std::size_t i = 0; i < image->undistorted_px.size(); ++i) {
        if ((image->undistorted_px[i] - center_px).norm() > 130) continue;
        part.undistorted_px.push_back(image->undistorted_px[i]);
        const auto begin = image->descriptors.begin() + static_cast<std::ptrdiff_t>(i * kDescriptorBytes);
        part.descriptors.insert(part.descriptors.end(), begin, begin + kDescriptorBytes);
      }
      *image = part;
    };
    small_part(&in.images[0], {320, 240});
    small_part(&in.images[1], {255, 240});
    const StartResult r = start_map(in.images, {});
    refused += !r.ok;
    if (!r.ok) continue;
    EXPECT_THAT(*r.cam_from_world[1], PoseNear(expected(in, r, 1), 0.05, 0.3)) << seed;
  }
  EXPECT_GT(refused, 0) << "the scene is meant to be ambiguous";
}

TEST(StartMap, OnePartOfTheImagesSharesView) {
  const test::SimWorld world({.points = 900});
  const Images in = images_of(world, {kThree[0], looking({0, 0, 0}, 3.0), kThree[1]});
  const StartResult r = start_map(in.images, {});
  ASSERT_TRUE(r.ok) << r.reason;
  EXPECT_TRUE(r.cam_from_world[0]);
  EXPECT_FALSE(r.cam_from_world[1]) << "it looks away";
  ASSERT_TRUE(r.cam_from_world[2]);
  EXPECT_THAT(*r.cam_from_world[2], PoseNear(expected(in, r, 2), 0.006, 0.03));
}

// A row of cameras along a long room: each is compared with some of the others, and all come into one map.
TEST(StartMap, ManyImagesAreNotAllComparedWithEachOther) {
  const test::SimWorld world({.points = 1500});
  std::vector<Rigid3> poses;
  for (int i = 0; i < 24; ++i) poses.push_back(looking({-2.4 + 0.2 * i, 0.1 * (i % 3), 0}));
  const Images in = images_of(world, poses);
  struct Counted : Workers {
    void each(std::size_t n, const Part& part) override {
      most = std::max(most, n);
      Workers::each(n, part);
    }
    std::size_t most = 0;
  } workers;
  const StartResult r = start_map(in.images, {}, workers);
  EXPECT_LT(workers.most, std::size_t{24 * 23 / 2 / 2});
  ASSERT_TRUE(r.ok) << r.reason;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    ASSERT_TRUE(r.cam_from_world[i]) << i;
    EXPECT_THAT(*r.cam_from_world[i], PoseNear(expected(in, r, i), 0.01, 0.05)) << i;
  }
  expect_points(world, in, r, 0.03);
}

void expect_reason(const std::vector<FeatureImage>& images) {
  const StartResult r = start_map(images, {});
  EXPECT_FALSE(r.ok);
  EXPECT_FALSE(r.reason.empty());
  EXPECT_EQ(r.cam_from_world.size(), images.size());
}

TEST(StartMap, NoOverlapIsAReason) {
  const test::SimWorld world({.points = 900});
  // One looks at the left end of the room, one at the right end.
  expect_reason(images_of(world, {looking({-3, 0, 4}, -1.2), looking({3, 0, 4}, 1.2)}).images);
}

TEST(StartMap, NoParallaxIsAReason) {
  const test::SimWorld world({});
  expect_reason(images_of(world, {looking({0, 0, 0}), looking({0.001, 0, 0}, 0.05)}).images);
}

TEST(StartMap, NothingToSeeIsAReason) {
  expect_reason({});
  const test::SimWorld world({.points = 25});
  expect_reason(images_of(world, {kThree[0]}).images);
  expect_reason(images_of(world, kThree).images);
  FeatureImage blank;
  blank.camera = test::sim_camera();
  expect_reason({blank, blank, blank});
}

std::vector<FeatureMatch> same_points(const Images& in) {
  std::vector<FeatureMatch> matches;
  for (std::size_t a = 0; a < in.world_points[0].size(); ++a) {
    for (std::size_t b = 0; b < in.world_points[1].size(); ++b) {
      if (in.world_points[0][a] == in.world_points[1][b])
        matches.push_back({static_cast<int>(a), static_cast<int>(b), 0});
    }
  }
  return matches;
}

TEST(StartFromMatches, TwoViewsOfOneCamera) {
  const test::SimWorld world({});
  const Images in = images_of(world, {looking({0, 0, 0}), looking({0.4, 0.05, 0.1}, 0.05)});
  const StartResult r = start_from_matches(in.images[0], in.images[1], same_points(in), {});
  ASSERT_TRUE(r.ok) << r.reason;
  EXPECT_THAT(*r.cam_from_world[0], PoseNear(Rigid3(), 1e-7, 1e-9));
  EXPECT_THAT(*r.cam_from_world[1], PoseNear(expected(in, r, 1), 0.006, 0.08));
  expect_points(world, in, r, 0.05);
}

TEST(StartFromMatches, APureTurnIsAReason) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const test::SimWorld world({.seed = seed});
    for (const double turn_rad : {0.05, 0.15, 0.3}) {
      const Images in = images_of(world, {looking({0, 0, 0}), looking({0, 0, 0}, turn_rad)});
      const StartResult r = start_from_matches(in.images[0], in.images[1], same_points(in), {});
      EXPECT_FALSE(r.ok) << seed << ' ' << turn_rad;
      EXPECT_FALSE(r.reason.empty());
    }
  }
}

// The first two cameras are a rig; the third one is free and sees the scene from farther away, so that it would be the
// better one of a pair.
TEST(StartMap, ARigStartsItInMetres) {
  const test::SimWorld world({});
  const std::vector<Rigid3> poses{looking({0, 0, 0}), looking({0.3, 0, 0}), looking({-1.2, 0.1, 0}, 0.05)};
  Images in = images_of(world, poses);
  for (const std::size_t i : {0U, 1U}) {
    in.images[i].rig = "left";
    in.images[i].cam_from_rig = poses[i] * poses[0].inverse();
  }
  const StartResult r = start_map(in.images, {});
  ASSERT_TRUE(r.ok) << r.reason;
  EXPECT_TRUE(r.metric);
  EXPECT_EQ(r.first, 0);
  EXPECT_EQ(r.second, 1);
  EXPECT_THAT(*r.cam_from_world[1], PoseNear(in.images[1].cam_from_rig, 1e-3, 2e-3));
  ASSERT_TRUE(r.cam_from_world[2]);
  EXPECT_THAT(*r.cam_from_world[2], PoseNear(poses[2] * poses[0].inverse(), 0.01, 0.05)) << "in metres";
}

TEST(StartMap, ARigThatTheImagesContradictIsNotUsed) {
  const test::SimWorld world({});
  const std::vector<Rigid3> poses{looking({0, 0, 0}), looking({0.3, 0, 0})};
  const Rigid3 right = poses[1] * poses[0].inverse();
  const Rigid3 turned{Eigen::Quaterniond(0, 1, 0, 0), right.translation};  // w x y z as x y z w
  for (const Rigid3& wrong : {right.inverse(), turned}) {
    Images in = images_of(world, poses);
    in.images[0].rig = in.images[1].rig = "left";
    in.images[1].cam_from_rig = wrong;
    const StartResult r = start_map(in.images, {});
    ASSERT_TRUE(r.ok) << r.reason;
    EXPECT_FALSE(r.metric);
    const Rigid3 in_unit{right.rotation, right.translation.normalized()};
    EXPECT_THAT(*r.cam_from_world[static_cast<std::size_t>(r.second)] *
                    r.cam_from_world[static_cast<std::size_t>(r.first)]->inverse(),
                PoseNear(r.first == 0 ? in_unit : in_unit.inverse(), 0.01, 0.05));
  }
}

TEST(StartMap, WithoutARigNothingIsMetric) {
  const test::SimWorld world({});
  const StartResult r = start_map(images_of(world, kThree).images, {});
  ASSERT_TRUE(r.ok);
  EXPECT_FALSE(r.metric);
}

}  // namespace
}  // namespace coslam::start_map_test
