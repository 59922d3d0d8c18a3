// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/patch_match.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "server/estimator/map/edit.h"
#include "tests/support/sim_world.h"

namespace coslam::patch_match_test {
namespace {

const test::SimWorld kWorld({.points = 200});

PatchGrey noise(unsigned seed) {
  std::minstd_rand random(seed);
  PatchGrey out;
  for (auto& g : out) g = static_cast<std::uint8_t>(random() >> 8);
  return out;
}

PatchGrey changed(const PatchGrey& patch, double gain, double bias) {
  PatchGrey out = patch;
  for (auto& g : out) g = static_cast<std::uint8_t>(std::lround(gain * g + bias));
  return out;
}

TEST(Zncc, IsOneForTheSameUnderAnotherLight) {
  const PatchGrey p = kWorld.patch(0);
  EXPECT_NEAR(zncc(p, p), 1, 1e-12);
  EXPECT_NEAR(zncc(p, changed(p, 0.5, 60)), 1, 1e-3);
  EXPECT_NEAR(zncc(p, changed(p, -1, 255)), -1, 1e-12);
}

TEST(Zncc, IsSmallForOthers) {
  double largest = 0;
  for (unsigned i = 2; i < 200; ++i) {
    const double value = zncc(noise(1), noise(i));
    EXPECT_DOUBLE_EQ(value, zncc(noise(i), noise(1)));
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
    out[static_cast<std::size_t>(i)] =
        static_cast<std::uint8_t>(std::lround(40 + 180 * std::exp(-(x * x + y * y) / 6)));
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

TEST(PeakIn, TellsWhereTheMiddleIs) {
  for (const auto& [dx, dy] : {std::pair(0.0, 0.0), std::pair(0.6, 0.0), std::pair(1.0, -0.3), std::pair(-0.9, 0.9)}) {
    const auto peak = peak_in(blob(0, 0), blob(dx, dy));
    ASSERT_TRUE(peak) << dx << " " << dy;
    EXPECT_GT(peak->zncc, 0.9);
    // Pixels of a patch, which is scaled to 30 %.
    EXPECT_NEAR(peak->shift_px.x(), dx / 0.3, 0.5) << dx << " " << dy;
    EXPECT_NEAR(peak->shift_px.y(), dy / 0.3, 0.5) << dx << " " << dy;
  }
}

TEST(PeakIn, NotFarOffAndNotWithoutAPeak) {
  EXPECT_FALSE(peak_in(blob(0, 0), blob(2.5, 0)));
  PatchGrey flat{}, edge{};
  flat.fill(100);
  for (int i = 0; i < kPatchBytes; ++i) edge[static_cast<std::size_t>(i)] = i % kPatchSide < 5 ? 40 : 200;
  EXPECT_FALSE(peak_in(flat, flat));
  EXPECT_FALSE(peak_in(edge, edge));
}

TEST(Warped, MovesTheContent) {
  const Eigen::Matrix2d larger = 1.5 * Eigen::Matrix2d::Identity(), turned = Eigen::Rotation2Dd(0.5).toRotationMatrix();
  EXPECT_EQ(warped(blob(1, 0), Eigen::Matrix2d::Identity()), blob(1, 0));
  const auto middle = [](const PatchGrey& p) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double weight = 0;
    for (int i = 0; i < kPatchBytes; ++i) {
      const double w = std::max(0, p[static_cast<std::size_t>(i)] - 100);
      sum += w * Eigen::Vector2d(i % kPatchSide - 5, i / kPatchSide - 5);
      weight += w;
    }
    return Eigen::Vector2d(sum / weight);
  };
  const Eigen::Vector2d at(1.5, -0.5);
  EXPECT_LT((middle(warped(blob(at.x(), at.y()), larger)) - larger * at).norm(), 0.15);
  EXPECT_LT((middle(warped(blob(at.x(), at.y()), turned)) - turned * at).norm(), 0.15);
}

// One point that was seen from 4 m, and the picture of a sign around it: a bright bar from the point to the right.
class FitPatchTest : public testing::Test {
 protected:
  FitPatchTest() {
    const CameraId id = edit_.add_camera("a", RunId(1), test::sim_camera());
    edit_.ingest({SetId(0), 0, {{id, {}, {}, {}}}});
    edit_.place(map_.camera(id), SetId(0), MapId(1), test::looking({0, 0, 0}), Why::kStartedAlone);
    point_.map = MapId(1);
    point_.position = {0, 0, 4};
    point_.patches.push_back({id, SetId(0), sign(0, 1)});
  }
  // As an upright camera sees it that is turned about its axis and `scale` times as near.
  static PatchGrey sign(double turn_rad, double scale) {
    PatchGrey out;
    for (int i = 0; i < kPatchBytes; ++i) {
      const Eigen::Vector2d seen(i % kPatchSide - 5, i / kPatchSide - 5);
      const Eigen::Vector2d d = Eigen::Rotation2Dd(-turn_rad) * seen / scale;
      const double bar = std::exp(-d.y() * d.y() / 2) / (1 + std::exp(-4 * d.x()));
      out[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::lround(60 + 150 * bar));
    }
    return out;
  }
  std::optional<PatchFit> fit(const Rigid3& pose, const PatchGrey& patch) {
    return fit_patch(map_, point_, map_.cameras().front(), pose, patch);
  }
  MapEdit edit_{MapConfig{}};
  const Map& map_ = edit_.map();
  MapPoint point_;
};

TEST_F(FitPatchTest, FromTheSamePlace) {
  const auto same = fit(test::looking({0, 0, 0}), sign(0, 1));
  ASSERT_TRUE(same);
  EXPECT_GT(same->zncc, 0.99);
  EXPECT_TRUE(same->same_centre);
}

TEST_F(FitPatchTest, ACameraOnItsSide) {
  const double turn = 0.6;
  const Rigid3 rolled{Eigen::Quaterniond(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ())), Eigen::Vector3d::Zero()};
  const auto fits = fit(rolled, sign(turn, 1));
  ASSERT_TRUE(fits);
  EXPECT_GT(fits->zncc, 0.9);
  EXPECT_TRUE(fits->same_centre);
  EXPECT_LT(zncc(sign(turn, 1), sign(0, 1)), 0.75) << "without the warp it does not";
}

TEST_F(FitPatchTest, FromNearerAndFarther) {
  for (const double scale : {0.6, 1.8}) {
    const auto fits = fit(test::looking({0, 0, 4 - 4 / scale}), sign(0, scale));
    ASSERT_TRUE(fits);
    EXPECT_GT(fits->zncc, 0.9) << scale;
    EXPECT_TRUE(fits->same_centre) << scale;
  }
}

TEST_F(FitPatchTest, ShiftsAreToldInTheSecondImage) {
  const double turn = 0.6;
  const MapCamera& camera = map_.cameras().front();
  const Rigid3 rolled{Eigen::Quaterniond(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ())), Eigen::Vector3d::Zero()};
  const PatchGrey seen = sign(0, 1), turned = sign(turn, 1);
  for (const bool swapped : {false, true}) {
    const PatchSight straight{&camera, test::looking({0, 0, 0}), &seen}, other{&camera, rolled, &turned};
    const auto alike =
        swapped ? made_alike(other, straight, point_.position) : made_alike(straight, other, point_.position);
    ASSERT_TRUE(alike);
    EXPECT_GT(zncc(alike->first, alike->second), 0.9);
    const double sense = swapped ? -turn : turn;
    const Eigen::Matrix2d second_by_view =
        alike->in_second ? Eigen::Matrix2d::Identity() : Eigen::Rotation2Dd(sense).toRotationMatrix();
    EXPECT_TRUE(alike->second_by_view.isApprox(second_by_view, 0.02)) << alike->second_by_view;
  }
}

TEST_F(FitPatchTest, TooDifferentDistancesAreNotCompared) {
  EXPECT_LT(fit(test::looking({0, 0, 3.5}), sign(0, 8))->zncc, 0);
}

TEST_F(FitPatchTest, WithoutAPatchThereIsNothingToSay) {
  point_.patches.clear();
  EXPECT_FALSE(fit(test::looking({0, 0, 0}), sign(0, 1)));
}

}  // namespace
}  // namespace coslam::patch_match_test
