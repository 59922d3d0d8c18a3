// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/fingerprint.h"

#include <gtest/gtest.h>

#include <set>

#include "server/estimator/map/map.h"

namespace coslam::fingerprint_test {
namespace {

MapPoint point() {
  MapPoint p;
  p.id = PointId(4);
  p.position = {1, 2, 3};
  p.key_observations.push_back({SetId(5), CameraId(1), TrackId(6), {7, 8}});
  p.patches.push_back({CameraId(1), SetId(5), {}, Eigen::Vector2f::Zero()});
  return p;
}

TEST(Fingerprint, TellsEveryKeptFieldOfAPoint) {
  std::set<std::uint64_t> all{fingerprint(point())};
  const auto changed = [&](auto change) {
    MapPoint p = point();
    change(p);
    return all.insert(fingerprint(p)).second;
  };
  EXPECT_FALSE(changed([](MapPoint&) {}));
  EXPECT_TRUE(changed([](MapPoint& p) { p.covariance(2, 1) = 1e-12; }));
  EXPECT_TRUE(changed([](MapPoint& p) { p.created = SetId(1); }));
  EXPECT_TRUE(changed([](MapPoint& p) { p.key_observations[0].undistorted_px.y() = 8.01F; }));
  EXPECT_TRUE(changed([](MapPoint& p) { p.key_observations[0].track = TrackId(7); }));
  EXPECT_TRUE(changed([](MapPoint& p) { p.patches[0].pixels.back() = 1; }));
  EXPECT_TRUE(changed([](MapPoint& p) { p.patches[0].offset_px.x() = 1; }));
  EXPECT_TRUE(changed([](MapPoint& p) { p.bound.push_back({CameraId(0), TrackId(0)}); }));
  EXPECT_TRUE(changed([](MapPoint& p) { p.phase = PointPhase::kTrial; }));
}

TEST(Fingerprint, TellsOfAFrame) {
  FramePose frame;
  const std::uint64_t bare = fingerprint(frame);
  frame.zoom_taken_out = 0.1F;
  EXPECT_NE(fingerprint(frame), bare);
}

}  // namespace
}  // namespace coslam::fingerprint_test
