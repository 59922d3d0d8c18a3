// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/pose/readout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "common/geometry/rigid3.h"
#include "tests/support/sim_world.h"

namespace coslam::readout_test {
namespace {

constexpr double kPeriod_s = 1.0 / 30;

TimeNs time_ns(int frame) { return to_ns(frame * kPeriod_s); }

// A camera that looks around, and sees each row at its own instant, with noise. Of what it sees a share moves by
// itself.
class LookingCamera {
 public:
  explicit LookingCamera(double readout_s, double moving_share = 0, int points = 250) : readout_s_(readout_s) {
    std::uniform_real_distribution<double> side(-0.8, 0.8), speed(-0.4, 0.4);
    for (int i = 0; i < points; ++i) {
      directions_.emplace_back(side(random_), side(random_), 1);
      const bool moves = i < moving_share * points;
      speeds_.emplace_back(moves ? speed(random_) : 0, moves ? speed(random_) : 0, 0);
    }
  }

  static Eigen::Vector3d turned_rad(double t_s) {
    return {0.25 * std::sin(5 * t_s), 0.3 * std::sin(4 * t_s), 0.1 * std::sin(3 * t_s)};
  }
  // Turn of the middle rows of two images, over the time between them, in the camera.
  static Eigen::Vector3d turn_rad_s(int frame) {
    const auto at = [](int f) { return so3_exp(turned_rad(f * kPeriod_s)); };
    return so3_log(at(frame) * at(frame - 1).conjugate()) / kPeriod_s;
  }

  std::vector<SeenPlace> image(int frame) {
    std::normal_distribution<double> noise_px(0, 0.3);
    std::vector<SeenPlace> out;
    for (std::size_t i = 0; i < directions_.size(); ++i) {
      double late_s = 0;  // the row that a point is seen in is that of its instant
      for (int k = 0; k < 15; ++k) late_s = (at(i, frame, late_s).y() / camera_.height_px - 0.5) * readout_s_;
      const Eigen::Vector2d px = at(i, frame, late_s) + Eigen::Vector2d(noise_px(random_), noise_px(random_));
      if (camera_.contains_raw(px)) out.push_back({TrackId(static_cast<std::uint32_t>(i + 1)), px.y(), px});
    }
    return out;
  }
  const CameraModel& camera() const { return camera_; }

 private:
  Eigen::Vector2d at(std::size_t i, int frame, double late_s) const {
    const double t_s = frame * kPeriod_s + late_s;
    return camera_.project(so3_exp(turned_rad(t_s)) * (directions_[i] + t_s * speeds_[i]));
  }

  const CameraModel camera_ = test::sim_camera();
  double readout_s_;
  std::mt19937 random_{3};
  std::vector<Eigen::Vector3d> directions_, speeds_;
};

ReadoutEstimate after(LookingCamera looking, int images) {
  ReadoutEstimate estimate(looking.camera());
  for (int frame = 0; frame < images; ++frame) estimate.take(time_ns(frame), looking.image(frame));
  return estimate;
}

TEST(ReadoutEstimate, IsFoundThoughAQuarterOfTheTracksMovesByItself) {
  EXPECT_NEAR(after(LookingCamera(0.02, 0.25), 90).readout_s(), 0.02, 0.003);
}

TEST(ReadoutEstimate, IsZeroAsLongAsItMayBeZero) {
  EXPECT_EQ(after(LookingCamera(0.02), 4).readout_s(), 0) << "a few images tell too little";
  EXPECT_EQ(after(LookingCamera(0, 0.25), 90).readout_s(), 0);
}

TEST(ReadoutEstimate, IsNeverLongerThanTheTimeFromImageToImage) {
  // Rows at instants farther apart than two images, as no camera has them.
  const double readout_s = after(LookingCamera(0.05), 90).readout_s();
  EXPECT_GT(readout_s, 0.03);
  EXPECT_LE(readout_s, kPeriod_s * (1 + 1e-6));
}

TEST(ReadoutEstimate, NeedsTracksInCommon) {
  EXPECT_EQ(after(LookingCamera(0.02, 0, 25), 90).readout_s(), 0) << "too few";
  LookingCamera looking(0.02);
  ReadoutEstimate estimate(looking.camera());
  for (int frame = 0; frame < 60; ++frame) {
    std::vector<SeenPlace> places = looking.image(frame);
    for (SeenPlace& p : places) p.track.value += 1000U * static_cast<std::uint32_t>(frame);
    estimate.take(time_ns(frame), places);
    EXPECT_FALSE(estimate.turn_rad_s()) << frame;
  }
  EXPECT_EQ(estimate.readout_s(), 0);
}

TEST(ReadoutEstimate, TheTurnIsThatBetweenTheNewestTwoImages) {
  LookingCamera looking(0, 0.2);
  ReadoutEstimate estimate(looking.camera());
  EXPECT_FALSE(estimate.turn_rad_s()) << "before any image";
  estimate.take(time_ns(0), looking.image(0));
  EXPECT_FALSE(estimate.turn_rad_s()) << "of one image";
  for (int frame = 1; frame < 8; ++frame) {
    estimate.take(time_ns(frame), looking.image(frame));
    ASSERT_TRUE(estimate.turn_rad_s());
    EXPECT_LT((*estimate.turn_rad_s() - LookingCamera::turn_rad_s(frame)).norm(), 0.03) << frame;
  }
}

TEST(ReadoutEstimate, ImagesWithoutTracksOrWithOneStampBreakNothing) {
  LookingCamera looking(0.02);
  ReadoutEstimate estimate(looking.camera());
  for (int frame = 0; frame < 90; ++frame) {
    if (frame % 30 == 7) estimate.take(time_ns(frame), std::vector<SeenPlace>());
    if (frame % 30 == 20) {
      estimate.take(time_ns(frame), looking.image(frame));
      estimate.take(time_ns(frame), looking.image(frame));
      EXPECT_FALSE(estimate.turn_rad_s()) << "no time has passed";
      continue;
    }
    estimate.take(time_ns(frame), looking.image(frame));
  }
  EXPECT_TRUE(std::isfinite(estimate.readout_s()));
  EXPECT_NEAR(estimate.readout_s(), 0.02, 0.004);
}

}  // namespace
}  // namespace coslam::readout_test
