// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/trajectory.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::trajectory_test {
namespace {

using ::testing::HasSubstr;

TEST(Trajectory, ReadsWhatItWrites) {
  const test::TempFolder folder;
  Trajectory written;
  for (int i = 0; i < 5; ++i) {
    const Rigid3 pose{so3_exp({0.1 * i, -0.2, 0.3}), {1.0 * i, -2.0, 0.5}};
    written.push_back({1403638518377829376 + i * 50'000'000, pose});
  }
  save_tum(folder / "a/b.tum", written);
  const Trajectory read = load_tum(folder / "a/b.tum");
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].t_ns, written[i].t_ns);
    EXPECT_LT(local(read[i].cam_from_world, written[i].cam_from_world).norm(), 1e-7);
  }
}

TEST(Trajectory, FileHoldsCameraToWorld) {
  const test::TempFolder folder;
  const auto file = folder.write("t.tum", "# comment\n\n0.5 1 2 3 0 0 0.70710678 0.70710678\n");
  const Trajectory t = load_tum(file);
  ASSERT_EQ(t.size(), 1u);
  EXPECT_EQ(t[0].t_ns, 500'000'000);
  EXPECT_LT((t[0].cam_from_world.center() - Eigen::Vector3d(1, 2, 3)).norm(), 1e-12);
  // Turned by +90 degrees about z: the camera's x axis points along the world's y.
  EXPECT_LT((t[0].cam_from_world * Eigen::Vector3d(1, 3, 3) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-7);
}

TEST(Trajectory, NamesFileAndLineOfABadLine) {
  const test::TempFolder folder;
  const std::string good = "0 0 0 0 0 0 0 1\n";
  for (const char* bad : {"1 0 0 0 0 0 0", "1 0 0 0 0 0 0 0", "1 0 0 0 0 0 0 2", "1 0 x 0 0 0 0 1", "1 0 nan 0 0 0 0 1",
                          "1 0 0 0 0 0 0 1 9"}) {
    const auto file = folder.write("t.tum", good + bad + "\n");
    EXPECT_THAT(test::error_of<UserError>([&] { load_tum(file); }), HasSubstr("t.tum:2: not a line")) << bad;
  }
  const auto file = folder.write("t.tum", good + good);
  EXPECT_THAT(test::error_of<UserError>([&] { load_tum(file); }), HasSubstr("t.tum:2: the time is not later"));
  EXPECT_THAT(test::error_of<UserError>([&] { load_tum(folder / "no.tum"); }), HasSubstr("no.tum: cannot be read"));
}

TEST(Trajectory, InterpolatesBetweenNeighbours) {
  const auto at = [](double x, double angle) {
    return Rigid3(so3_exp({0, 0, angle}), {x, 0, 0}).inverse();  // given camera to world
  };
  const Trajectory t = {{100, at(0, 0)}, {200, at(2, 1)}, {1000, at(3, 1)}};
  EXPECT_EQ(pose_at(t, 99, 500), std::nullopt);
  EXPECT_EQ(pose_at(t, 1001, 5000), std::nullopt);
  EXPECT_EQ(pose_at(t, 600, 500), std::nullopt);  // the gap is too wide
  EXPECT_TRUE(pose_at(t, 1000, 0));
  const auto half = pose_at(t, 150, 500);
  ASSERT_TRUE(half);
  EXPECT_LT((half->center() - Eigen::Vector3d(1, 0, 0)).norm(), 1e-12);
  EXPECT_LT(half->rotation.angularDistance(so3_exp({0, 0, -0.5})), 1e-12);
  EXPECT_EQ(pose_at({}, 0, 1), std::nullopt);
}

}  // namespace
}  // namespace coslam::trajectory_test
