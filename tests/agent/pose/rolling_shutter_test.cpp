// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/pose/rolling_shutter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "common/geometry/rigid3.h"
#include "tests/support/sim_world.h"

namespace coslam::rolling_shutter_test {
namespace {

constexpr double kReadout_s = 0.03, kPeriod_s = 1.0 / 30;

// A camera that turns steadily and sees far points, each row at its own instant.
class TurningCamera {
 public:
  TurningCamera(const Eigen::Vector3d& turn_rad_s, double readout_s) : turn_rad_s_(turn_rad_s), readout_s_(readout_s) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> side(-0.7, 0.7);
    for (int i = 0; i < 200; ++i) directions_.emplace_back(side(random), side(random), 1);
  }
  // At the instant t of the middle row.
  Eigen::Vector2d at(std::size_t i, double t_s) const {
    return camera_.project(so3_exp(t_s * turn_rad_s_) * directions_[i]);
  }
  std::vector<SeenPlace> image(int frame) const {
    std::vector<SeenPlace> out;
    for (std::size_t i = 0; i < directions_.size(); ++i) {
      // The row that a point is seen in is that of its instant.
      double late_s = 0;
      for (int k = 0; k < 20; ++k) late_s = (row(i, frame, late_s) / camera_.height_px - 0.5) * readout_s_;
      const Eigen::Vector2d px = at(i, frame * kPeriod_s + late_s);
      if (camera_.contains_raw(px)) out.push_back({TrackId(static_cast<std::uint32_t>(i + 1)), px.y(), px});
    }
    return out;
  }
  double worst_px(const std::vector<SeenPlace>& places, int frame) const {
    double worst = 0;
    for (const SeenPlace& p : places) {
      worst = std::max(worst, (p.undistorted_px - at(p.track.value - 1, frame * kPeriod_s)).norm());
    }
    return worst;
  }
  const CameraModel& camera() const { return camera_; }

 private:
  double row(std::size_t i, int frame, double late_s) const { return at(i, frame * kPeriod_s + late_s).y(); }

  CameraModel camera_ = test::sim_camera();
  Eigen::Vector3d turn_rad_s_;
  double readout_s_;
  std::vector<Eigen::Vector3d> directions_;
};

TimeNs time_ns(int frame) { return to_ns(frame * kPeriod_s); }

TEST(RollingShutter, PlacesAreBroughtToTheMiddleRow) {
  const TurningCamera turning({0.4, 1.0, -0.6}, kReadout_s);
  RollingShutter shutter(turning.camera(), kReadout_s);
  for (int frame = 0; frame < 4; ++frame) {
    std::vector<SeenPlace> places = turning.image(frame);
    ASSERT_GT(places.size(), 100U);
    EXPECT_GT(turning.worst_px(places, frame), 5);
    shutter.correct(time_ns(frame), &places);
    if (frame > 0) {
      EXPECT_LT(turning.worst_px(places, frame), 0.5)
          << "the turn between the middle rows is that between the rows, nearly";
    }
  }
}

TEST(RollingShutter, NearAndMovingThingsDoNotCount) {
  const TurningCamera turning({0, 1.0, 0}, kReadout_s);
  RollingShutter shutter(turning.camera(), kReadout_s);
  for (int frame = 0; frame < 3; ++frame) {
    std::vector<SeenPlace> places = turning.image(frame);
    const std::size_t others = places.size() / 4;
    for (std::size_t i = 0; i < others; ++i) places[i].undistorted_px.x() += 12.0 * frame;
    shutter.correct(time_ns(frame), &places);
    places.erase(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(others));
    if (frame == 0) continue;
    EXPECT_LT(turning.worst_px(places, frame), 0.5);
  }
}

// Looks around: its turn changes all the time, as much sideways as up and down.
class LookingAround {
 public:
  explicit LookingAround(double readout_s, double way_m = 0) : readout_s_(readout_s), way_m_(way_m) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> side(-0.9, 0.9), inverse_depth(0.1, 0.5);
    for (int i = 0; i < 300; ++i) {
      places_.emplace_back(Eigen::Vector3d(side(random), side(random), 1) / inverse_depth(random));
    }
  }
  Eigen::Vector2d at(std::size_t i, double t_s) const {
    const Eigen::Vector3d turned_rad(0.2 * std::sin(5 * t_s), 0.3 * std::sin(4 * t_s), 0.1 * std::sin(3 * t_s));
    return camera_.project(so3_exp(turned_rad) *
                           (places_[i] - way_m_ * Eigen::Vector3d(std::cos(2 * t_s), std::sin(3 * t_s), 0)));
  }
  std::vector<SeenPlace> image(int frame) {
    std::normal_distribution<double> noise_px(0, 0.3);
    std::vector<SeenPlace> out;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      double late_s = 0;
      for (int k = 0; k < 20; ++k) {
        late_s = (at(i, frame * kPeriod_s + late_s).y() / camera_.height_px - 0.5) * readout_s_;
      }
      const Eigen::Vector2d px =
          at(i, frame * kPeriod_s + late_s) + Eigen::Vector2d(noise_px(random_), noise_px(random_));
      if (camera_.contains_raw(px)) out.push_back({TrackId(static_cast<std::uint32_t>(i + 1)), px.y(), px});
    }
    return out;
  }
  const CameraModel& camera() const { return camera_; }

 private:
  CameraModel camera_ = test::sim_camera();
  double readout_s_, way_m_;
  std::mt19937 random_{7};
  std::vector<Eigen::Vector3d> places_;
};

double found_s(LookingAround looking, int images) {
  RollingShutter shutter(looking.camera(), -1);
  for (int frame = 0; frame < images; ++frame) {
    std::vector<SeenPlace> places = looking.image(frame);
    shutter.correct(time_ns(frame), &places);
  }
  return shutter.readout_s();
}

TEST(RollingShutter, ItsReadoutIsFoundWhileTheCameraLooksAround) {
  EXPECT_NEAR(found_s(LookingAround(0.02), 60), 0.02, 0.002);
  EXPECT_NEAR(found_s(LookingAround(kReadout_s), 60), kReadout_s, 0.003);
}

TEST(RollingShutter, ItsReadoutIsFoundWhileTheCameraMovesToo) {
  EXPECT_NEAR(found_s(LookingAround(kReadout_s, 0.3), 120), kReadout_s, 0.006);
}

TEST(RollingShutter, OfAGlobalShutterNoneIsFound) {
  EXPECT_EQ(found_s(LookingAround(0), 120), 0);
  EXPECT_EQ(found_s(LookingAround(0, 0.3), 120), 0);
}

TEST(RollingShutter, WithoutATurnNoneIsFound) {
  const TurningCamera still({0, 0, 0}, kReadout_s);
  RollingShutter shutter(still.camera(), -1);
  for (int frame = 0; frame < 60; ++frame) {
    std::vector<SeenPlace> places = still.image(frame);
    shutter.correct(time_ns(frame), &places);
  }
  EXPECT_EQ(shutter.readout_s(), 0);
}

TEST(RollingShutter, AnImageThatIsLookedAtTwiceIsCorrectedTwice) {
  const TurningCamera turning({0.4, 1.0, -0.6}, kReadout_s);
  RollingShutter shutter(turning.camera(), kReadout_s);
  for (int frame = 0; frame < 3; ++frame) {
    std::vector<SeenPlace> places = turning.image(frame);
    shutter.correct(time_ns(frame), &places);
  }
  std::vector<SeenPlace> again = turning.image(2);
  shutter.correct(time_ns(2), &again);
  EXPECT_LT(turning.worst_px(again, 2), 0.5);
}

TEST(RollingShutter, AGlobalShutterIsLeftAlone) {
  const TurningCamera turning({0.4, 1.0, -0.6}, 0);
  RollingShutter shutter(turning.camera(), 0);
  for (int frame = 0; frame < 3; ++frame) {
    std::vector<SeenPlace> places = turning.image(frame);
    shutter.correct(time_ns(frame), &places);
    EXPECT_LT(turning.worst_px(places, frame), 1e-9);
  }
}

TEST(RollingShutter, WithoutTracksInCommonNothingIsChanged) {
  const TurningCamera turning({0.4, 1.0, -0.6}, kReadout_s);
  RollingShutter shutter(turning.camera(), kReadout_s);
  std::vector<SeenPlace> places = turning.image(0);
  shutter.correct(time_ns(0), &places);
  std::vector<SeenPlace> next = turning.image(1);
  for (SeenPlace& p : next) p.track.value += 1000;
  const std::vector<SeenPlace> before = next;
  shutter.correct(time_ns(1), &next);
  for (std::size_t i = 0; i < next.size(); ++i) EXPECT_EQ(next[i].undistorted_px, before[i].undistorted_px);
}

}  // namespace
}  // namespace coslam::rolling_shutter_test
