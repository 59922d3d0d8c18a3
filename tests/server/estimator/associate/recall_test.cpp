// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/recall.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "server/estimator/associate/fuse.h"
#include "server/estimator/associate/register.h"
#include "tests/support/sim_map.h"

namespace coslam::recall_test {
namespace {

constexpr CameraId kCam0(0);

// One camera mapped all that it sees at key frames, and nobody has seen it for more than recent_s since, though its
// tracks live.
class RecallTest : public ::testing::Test {
 protected:
  RecallTest() : sim_(world_, test::paths_side_by_side(1), {}, short_memory()) {
    sim_.advance(1, true);
    sim_.add_points(0.002);
    for (int i = 0; i < 3; ++i) {
      sim_.edit.add_key_frame(sim_.set.id);
      sim_.advance(2, true);
    }
    for (const MapPoint* p : sim_.map.recent_points()) {
      if (!p->bound.empty()) all_.push_back(p->id);
    }
  }
  static MapConfig short_memory() {
    MapConfig config;
    config.recent_s = 0.3;
    return config;
  }
  // The camera goes on with so many of its points.
  void go_on_with(std::size_t points) {
    for (std::size_t i = points; i < all_.size(); ++i) {
      const BoundTrack b = sim_.map.find(all_[i])->bound.front();
      sim_.edit.unbind(b.camera, sim_.map.track(b), Why::kOutsideGate);
    }
    for (int i = 0; i < 12; ++i) {
      sim_.advance(1, true);
      for (std::size_t k = 0; k < points; ++k) sim_.edit.keep_recent(*sim_.map.find(all_[k]));
    }
  }

  const test::SimWorld world_{{}};
  test::SimMap sim_;
  std::vector<PointId> all_;
};

TEST_F(RecallTest, WhoSeesSomeOfAPlaceIsToldOfAll) {
  go_on_with(10);
  const auto recalled = points_of_earlier_visits(sim_.map, {kCam0});
  for (std::size_t i = 0; i < all_.size(); ++i) {
    EXPECT_EQ(std::ranges::count(recalled, all_[i], &MapPoint::id), i < 10 ? 0 : 1) << "but for those that are seen";
  }
  EXPECT_TRUE(std::ranges::is_sorted(recalled, {}, &MapPoint::id));
  for (const MapPoint* p : recalled) EXPECT_FALSE(sim_.map.is_recent(p->last_seen));
}

TEST_F(RecallTest, AFewPointsTellNoPlace) {
  go_on_with(3);
  EXPECT_TRUE(points_of_earlier_visits(sim_.map, {kCam0}).empty());
}

TEST_F(RecallTest, WhatIsOnTrialOrMovesIsNoPlace) {
  go_on_with(10);
  const MapPoint& moving = *sim_.map.find(all_[10]);
  sim_.set_moving(moving);
  for (const MapPoint* p : points_of_earlier_visits(sim_.map, {kCam0})) EXPECT_NE(p->id, moving.id);
}

TEST_F(RecallTest, WhatWasMadeASecondTimeBecomesOne) {
  go_on_with(10);
  int made = 0;
  for (std::size_t i = 10; i < 40; ++i) {
    const int corner = sim_.world_point(*sim_.map.find(all_[i]));
    const ServerTrack* t = sim_.track_of(kCam0, corner);
    if (t == nullptr) continue;
    const MapPoint& again = sim_.create(world_.position(corner));
    sim_.bind(again, kCam0, *t);
    sim_.edit.forget_past(again);  // as if the track had begun after the key frames
    ++made;
  }
  ASSERT_GT(made, 15);
  EXPECT_GE(fuse_points(sim_.edit, sim_.set).fused, 0.8 * made);
  for (const auto& [id, p] : sim_.map.points()) {
    for (const BoundTrack& b : p.bound) EXPECT_EQ(sim_.world_point(b.camera, b.track), sim_.world_point(p));
  }
}

TEST_F(RecallTest, ItsTracksFindTheirPointsAgain) {
  go_on_with(10);
  int registered = 0;
  for (int i = 0; i < 6; ++i) {
    sim_.advance(1, true);
    registered += register_tracks(sim_.edit, sim_.set).registered;
  }
  EXPECT_GT(registered, 0.8 * static_cast<double>(all_.size() - 10));
  for (const auto& [id, p] : sim_.map.points()) {
    for (const BoundTrack& b : p.bound) EXPECT_EQ(sim_.world_point(b.camera, b.track), sim_.world_point(p));
  }
}

}  // namespace
}  // namespace coslam::recall_test
