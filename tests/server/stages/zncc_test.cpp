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

// A blob, its middle off the centre of the patch.
PatchGrey blob(double dx, double dy) {
  PatchGrey out;
  for (int i = 0; i < kPatchBytes; ++i) {
    const double x = i % kPatchSide - 5 - dx, y = i / kPatchSide - 5 - dy;
    out[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::lround(40 + 180 * std::exp(-(x * x + y * y) / 6)));
  }
  return quantised_patch(out);
}

TEST(SameCentre, WithinAPixelOrSo) {
  EXPECT_TRUE(same_centre(blob(0, 0), blob(0, 0)));
  EXPECT_TRUE(same_centre(blob(0, 0), changed(blob(0.2, -0.2), 0.5, 60)));
  EXPECT_TRUE(same_centre(blob(0.9, 0.4), blob(1.1, 0.2))) << "wherever in the patch";
  for (const auto& [dx, dy] : {std::pair(0.7, 0.0), std::pair(0.0, -0.7), std::pair(0.5, 0.5), std::pair(2.0, 0.0)}) {
    EXPECT_FALSE(same_centre(blob(0, 0), blob(dx, dy))) << dx << " " << dy;
    EXPECT_FALSE(same_centre(blob(dx, dy), blob(0, 0))) << dx << " " << dy;
  }
  EXPECT_GT(zncc(blob(0, 0), blob(0.7, 0)), 0.8) << "correlation alone does not tell";
}

TEST(SameCentre, WithoutAPeakNothingIsKnown) {
  PatchGrey flat{}, edge{};
  flat.fill(100);
  for (int i = 0; i < kPatchBytes; ++i) edge[static_cast<std::size_t>(i)] = i % kPatchSide < 5 ? 40 : 200;
  EXPECT_FALSE(same_centre(flat, flat));
  EXPECT_FALSE(same_centre(edge, edge));
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
