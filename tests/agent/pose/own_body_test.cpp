// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/pose/own_body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "common/geometry/rigid3.h"

namespace coslam::own_body_test {
namespace {

constexpr int kWidth = 640, kHeight = 480;
constexpr TimeNs kPeriod_ns = 50'000'000;

CameraModel camera() {
  CameraModel c;
  c.width_px = kWidth;
  c.height_px = kHeight;
  c.fx = c.fy = 400;
  c.cx = 319.5;
  c.cy = 239.5;
  return c;
}

// Directions of things far away all around, and places in the picture that move with the camera.
class OwnBodyTest : public testing::Test {
 protected:
  OwnBodyTest() {
    std::normal_distribution<double> any(0, 1);
    for (int i = 0; i < 3000; ++i)
      far_.emplace_back(Eigen::Vector3d(any(random_), any(random_), any(random_)).normalized());
  }
  // Everything below that row moves with the camera.
  void cover_below(float row_px) {
    std::uniform_real_distribution<float> x(5, kWidth - 5), y(row_px + 4, kHeight - 5);
    rim_px_ = row_px;
    for (int i = 0; i < 120; ++i) body_.emplace_back(x(random_), y(random_));
  }
  // Seconds of images, the camera turned about x and y as `turn` says of each instant. What was found.
  template <class Turn>
  double look(double time_s, Turn turn) {
    for (const TimeNs end_ns = t_ns_ + to_ns(time_s); t_ns_ < end_ns; t_ns_ += kPeriod_ns) {
      body.step(t_ns_, seen(so3_exp(turn(to_seconds(t_ns_)))));
    }
    return body.share();
  }
  std::vector<Track> seen(const Eigen::Quaterniond& cam_from_world) {
    std::normal_distribution<float> noise(0, 0.2F);
    std::vector<Track> out;
    for (std::size_t i = 0; i < far_.size(); ++i) {
      const Eigen::Vector3d in_cam = cam_from_world * far_[i];
      if (in_cam.z() < 0.1) continue;
      const Eigen::Vector2f px = camera_.project(in_cam).cast<float>();
      if (px.x() < 0 || px.y() < 0 || px.x() > kWidth - 1 || px.y() > rim_px_) continue;
      out.push_back(
          {TrackId(static_cast<std::uint32_t>(i + 1)), px + Eigen::Vector2f(noise(random_), noise(random_)), 3});
    }
    for (std::size_t i = 0; i < body_.size(); ++i) {
      out.push_back({TrackId(static_cast<std::uint32_t>(10000 + i)),
                     body_[i] + Eigen::Vector2f(noise(random_), noise(random_)), 3});
    }
    return out;
  }
  static Eigen::Vector3d swing(double t_s) { return {0.2 * std::sin(1.1 * t_s), 0.4 * std::sin(0.8 * t_s), 0}; }

  std::mt19937 random_{5};
  const CameraModel camera_ = camera();
  std::vector<Eigen::Vector3d> far_;
  std::vector<Eigen::Vector2f> body_;
  float rim_px_ = kHeight - 1;
  TimeNs t_ns_ = 0;
  OwnBody body{camera_};
};

TEST_F(OwnBodyTest, AHoodIsFoundWhereTheCameraTurns) {
  cover_below(320);  // a third of the rows
  EXPECT_EQ(look(2, swing), 0) << "too soon to tell";
  const double share = look(20, swing);
  EXPECT_GT(share, 0.2) << "but for cells where nothing is to be followed";
  EXPECT_LT(share, 0.34);
  const ImageParts parts = body.found();
  ASSERT_EQ(parts.cells.size(), static_cast<std::size_t>(parts.columns) * static_cast<std::size_t>(parts.rows));
  for (int row = 0; row < parts.rows; ++row) {
    for (int column = 0; column < parts.columns; ++column) {
      const bool below = (row + 1) * kHeight > 320 * parts.rows;
      EXPECT_TRUE(below || !parts.cells[static_cast<std::size_t>(row * parts.columns + column)]) << row;
    }
  }
}

TEST_F(OwnBodyTest, NothingIsFoundWithoutOne) { EXPECT_EQ(look(30, swing), 0); }

TEST_F(OwnBodyTest, NothingIsFoundWhileTheCameraStands) {
  cover_below(320);
  EXPECT_EQ(look(30, [](double) { return Eigen::Vector3d(0, 0, 0); }), 0);
}

TEST_F(OwnBodyTest, ARiverBeforeACameraThatStandsIsNotATurn) {
  cover_below(240);  // the other half flows one way
  EXPECT_EQ(look(30, [](double t_s) { return Eigen::Vector3d(0, 0.1 * t_s, 0); }), 0);
}

TEST_F(OwnBodyTest, ARoadThatIsNowSeenAndNowPassedBySomethingIsNotOne) {
  // What passes covers the left or the right half of the lower picture, by turns, and the rest of it stands.
  cover_below(0);
  std::uniform_real_distribution<float> any(0, 1);
  for (int i = 0; i < 1200; ++i, t_ns_ += kPeriod_ns) {
    const double t_s = to_seconds(t_ns_);
    const bool left = std::fmod(t_s, 8) < 4;
    std::vector<Track> out;
    for (const Track& t : seen(Eigen::Quaterniond::Identity())) {
      const bool passed = t.raw_px.y() > 200 && (t.raw_px.x() < kWidth / 2.0F) == left;
      if (!passed) out.push_back(t);
    }
    const float way_px = static_cast<float>(60 * std::sin(t_s));
    for (int k = 0; k < 60; ++k) {
      const auto column = static_cast<float>(k % 10), row = static_cast<float>(k / 10);
      const Eigen::Vector2f px(70 + 20 * column + (left ? 0 : kWidth / 2) + way_px, 220 + 40 * row);
      out.push_back({TrackId(static_cast<std::uint32_t>(20000 + 100 * static_cast<int>(t_s / 4) + k)), px, 3});
    }
    body.step(t_ns_, out);
  }
  EXPECT_EQ(body.share(), 0);
}

}  // namespace
}  // namespace coslam::own_body_test
