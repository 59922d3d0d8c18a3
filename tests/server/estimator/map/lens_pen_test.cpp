// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/lens_pen.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/map_checks.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

// Paths of what moves, and zooms at the ends of a run. What else a lens moves is in edit_lens_test.cpp.
namespace coslam::lens_pen_test {
namespace {

using test::VectorNear;

constexpr CameraId kCam0(0), kCam1(1);

class LensPenTest : public testing::Test {
 protected:
  LensPenTest() {
    lens_.values << 0.03, 3, -2, 0.002, 0.001, -0.001, 0.01, -0.004, 0, 0.001, 0, 0;
    sim_.advance(8);
  }
  const MapCamera& camera(CameraId id) const { return sim_.map.camera(id); }
  Eigen::Vector2d raw_px(CameraId id, const Eigen::Vector2f& px) const { return camera(id).raw_px(px.cast<double>()); }

  const test::SimWorld world_{{.points = 60}};
  test::SimMap sim_{world_, test::paths_side_by_side(2)};
  MapEdit& edit_ = sim_.edit;
  LensCorrection lens_;
};

TEST_F(LensPenTest, WhatMovesStaysWhereItWasSeenInTheRawImage) {
  const PointId id = sim_.create({0, 0, 5}, 0.01, PointPhase::kMoving).id;
  const Eigen::Vector2f at(400, 120), step(6, -3);
  edit_.record_motion(id, {sim_.set.id, sim_.set.t_ns, {{kCam0, at, step}, {kCam1, at, step}, {kCam0, at}}});
  const Eigen::Vector2d now = raw_px(kCam0, at), earlier = raw_px(kCam0, at - step);
  edit_.correct_lens(camera(kCam0), lens_, LensCorrection::Values::Zero());
  const std::vector<Sighting>& seen = sim_.map.motions().at(id)[0].seen;
  EXPECT_GT((seen[0].undistorted_px - at).norm(), 1) << "this lens is far from the other";
  EXPECT_THAT(raw_px(kCam0, seen[0].undistorted_px), VectorNear(now, 1e-3));
  EXPECT_THAT(raw_px(kCam0, seen[0].undistorted_px - seen[0].step_px), VectorNear(earlier, 1e-3));
  EXPECT_EQ(seen[1].undistorted_px, at) << "the other camera saw it through its own lens";
  EXPECT_EQ(seen[1].step_px, step);
  EXPECT_THAT(raw_px(kCam0, seen[2].undistorted_px), VectorNear(now, 1e-3));
  EXPECT_EQ(seen[2].step_px, Eigen::Vector2f::Zero()) << "where its track began";
}

TEST_F(LensPenTest, TheSameLensMovesNothing) {
  edit_.correct_lens(camera(kCam0), lens_, LensCorrection::Values::Zero());
  const MapEdit before = edit_;
  edit_.correct_lens(camera(kCam0), lens_, LensCorrection::Values::Zero());
  test::expect_same(sim_.map, before.map());
}

TEST_F(LensPenTest, WithoutZoomsNothingIsTakenOut) {
  const MapEdit before = edit_;
  edit_.leave_zoom_out(camera(kCam0), {});
  test::expect_same(sim_.map, before.map());
}

TEST_F(LensPenTest, BeyondTheFirstAndTheLastTheZoomIsTheirs) {
  const std::vector<FrameZoom> zooms{{SetId(3), 0.02}, {SetId(5), -0.01}};
  edit_.leave_zoom_out(camera(kCam0), zooms);
  edit_.leave_zoom_out(camera(kCam0), zooms);
  for (const FramePose& f : camera(kCam0).frames) {
    const double expected = f.set <= SetId(3) ? 0.02 : f.set >= SetId(5) ? -0.01 : 0.005;
    EXPECT_NEAR(f.zoom_taken_out, 2 * expected, 1e-7) << "they add up; set " << f.set.value;
  }
  for (const FramePose& f : camera(kCam1).frames) EXPECT_EQ(f.zoom_taken_out, 0);
}

TEST_F(LensPenTest, AnotherCalibrationForgetsWhatWasWrongAboutTheFirst) {
  edit_.correct_lens(camera(kCam0), lens_, LensCorrection::Values::Constant(0.5));
  edit_.note_breathing(camera(kCam0), 0.03);
  CameraModel other = camera(kCam0).model;
  other.fx *= 1.1;
  edit_.restart_camera(kCam0, RunId(9), other);
  EXPECT_EQ(camera(kCam0).model, other);
  EXPECT_TRUE(camera(kCam0).lens.none());
  EXPECT_EQ(camera(kCam0).lens_sigma, LensCorrection::Values::Zero());
  EXPECT_EQ(camera(kCam0).breathing, 0);
}

}  // namespace
}  // namespace coslam::lens_pen_test
