// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/stages/zncc.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/sim_world.h"

namespace coslam {
namespace {

const test::SimWorld kWorld({.points = 200});

PatchGrey changed(const PatchGrey& patch, double gain, double bias) {
  PatchGrey out = patch;
  for (auto& g : out) g = static_cast<std::uint8_t>(std::lround(gain * g + bias));
  return out;
}

TEST(Zncc, IsOneForTheSameUnderAnotherLight) {
  const PatchGrey& p = kWorld.patch(0);
  EXPECT_NEAR(zncc(p, p), 1, 1e-12);
  EXPECT_NEAR(zncc(p, changed(p, 0.5, 60)), 1, 1e-3);
  EXPECT_NEAR(zncc(p, changed(p, -1, 255)), -1, 1e-12);
}

TEST(Zncc, IsSmallForOthers) {
  double largest = 0;
  for (int i = 1; i < kWorld.size(); ++i) {
    const double value = zncc(kWorld.patch(0), kWorld.patch(i));
    EXPECT_DOUBLE_EQ(value, zncc(kWorld.patch(i), kWorld.patch(0)));
    largest = std::max(largest, std::abs(value));
  }
  EXPECT_LT(largest, 0.5);  // of 121 independent values the standard deviation is 0.09
}

TEST(Zncc, AFlatPatchMatchesNothing) {
  PatchGrey flat{}, nearly{};
  flat.fill(100);
  nearly.fill(100);
  nearly[5] = 101;
  EXPECT_EQ(zncc(flat, flat), 0);
  EXPECT_EQ(zncc(nearly, nearly), 0);
  EXPECT_EQ(zncc(flat, kWorld.patch(0)), 0);
}

TEST(NearestPatch, IsTheOneFromTheNearestDirection) {
  MapPoint p;
  EXPECT_EQ(nearest_patch(p, {0, 0, 1}), nullptr);
  p.patches.push_back({CameraId(0), Eigen::Vector3d(0, 0, 1), kWorld.patch(0)});
  p.patches.push_back({CameraId(1), Eigen::Vector3d(1, 0, 1).normalized(), kWorld.patch(1)});
  EXPECT_EQ(nearest_patch(p, {0, 0, 1}), &p.patches[0]);
  EXPECT_EQ(nearest_patch(p, Eigen::Vector3d(1, 0, 0.5).normalized()), &p.patches[1]);
  EXPECT_NE(nearest_patch(p, {0, 0, -1}), nullptr) << "some patch is better than none";
}

}  // namespace
}  // namespace coslam
