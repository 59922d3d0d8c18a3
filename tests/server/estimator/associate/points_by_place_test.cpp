// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/points_by_place.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include "tests/support/sim_map.h"

namespace coslam::points_by_place_test {
namespace {

constexpr CameraId kCam0(0), kCam1(1);

// Two cameras and many points, most of them out of sight.
class PointsByPlaceTest : public testing::Test {
 protected:
  PointsByPlaceTest() : sim_(world_, test::paths_side_by_side(2)) {
    sim_.advance(6, true);
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> place(-15, 15), sigma(0.001, 0.2);
    for (int i = 0; i < 2000; ++i) {
      const double sigma_m = sigma(random), z = place(random), y = place(random), x = place(random);
      sim_.create(Eigen::Vector3d(x, y, z), sigma_m);
    }
  }
  const MapCamera& camera(CameraId id) const { return sim_.map.camera(id); }
  static TrackGrid all_tracks(const MapCamera& camera) {
    return TrackGrid(camera, [](const ServerTrack&) { return true; });
  }
  std::vector<const MapPoint*> points() const {
    std::vector<const MapPoint*> out;
    for (const auto& [id, p] : sim_.map.points()) out.push_back(&p);
    return out;
  }
  // Those for which a track is near enough, by a look at each point and each track.
  std::set<PointId> with_tracks(const MapCamera& camera, const TrackGrid& grid, const SearchRadius& radius) const {
    std::set<PointId> out;
    for (const MapPoint* p : points()) {
      if (p->map != camera.map) continue;
      const auto window =
          search_window(camera.model, camera.frames.back().cam_from_world, *p, radius.noise_px, radius.sigmas);
      if (!window) continue;
      grid.near(window->px, window->radius_px, [&](const TrackGrid::InGrid& t) {
        if ((t.px - window->px).norm() <= window->radius_px) out.insert(p->id);
      });
    }
    return out;
  }
  static std::set<PointId> ids(const std::vector<const MapPoint*>& points) {
    std::set<PointId> out;
    for (const MapPoint* p : points) out.insert(p->id);
    return out;
  }

  const test::SimWorld world_{{}};
  test::SimMap sim_;
  const SearchRadius radius_{.sigmas = 2, .noise_px = 3};
};

TEST_F(PointsByPlaceTest, FindsAllThatAreNearATrackAndFewOthers) {
  const PointsByPlace places(points());
  for (const CameraId id : {kCam0, kCam1}) {
    const TrackGrid grid = all_tracks(camera(id));
    const auto found = places.near_tracks(camera(id), grid, radius_);
    const std::set<PointId> expected = with_tracks(camera(id), grid, radius_);
    EXPECT_GT(expected.size(), 50U);
    EXPECT_TRUE(std::ranges::includes(ids(found), expected));
    EXPECT_LT(found.size(), 2 * expected.size() + 100) << "of 2000";
    EXPECT_TRUE(std::ranges::is_sorted(found, {}, &MapPoint::id));
  }
}

TEST_F(PointsByPlaceTest, AFewFarOutHideNothing) {
  const auto before = PointsByPlace(points()).near_tracks(camera(kCam0), all_tracks(camera(kCam0)), radius_).size();
  for (const double far : {-1e7, 1e4, 1e9}) sim_.create(Eigen::Vector3d::Constant(far));
  const TrackGrid grid = all_tracks(camera(kCam0));
  const auto found = PointsByPlace(points()).near_tracks(camera(kCam0), grid, radius_);
  EXPECT_TRUE(std::ranges::includes(ids(found), with_tracks(camera(kCam0), grid, radius_)));
  EXPECT_GE(found.size(), before);
}

TEST_F(PointsByPlaceTest, OnePointIsAPlace) {
  const TrackGrid grid = all_tracks(camera(kCam0));
  const std::set<PointId> expected = with_tracks(camera(kCam0), grid, radius_);
  ASSERT_FALSE(expected.empty());
  const MapPoint* one = sim_.map.find(*expected.begin());
  EXPECT_EQ(PointsByPlace({one}).near_tracks(camera(kCam0), grid, radius_), std::vector{one});
}

TEST_F(PointsByPlaceTest, NotThoseOfAnotherMap) {
  const MapId other = sim_.edit.new_map(Why::kStartedAlone, 0);
  const PointId stranger = sim_.create(other, world_.position(0), 0.01).id;
  const PointsByPlace places(points());
  EXPECT_FALSE(ids(places.near_tracks(camera(kCam0), all_tracks(camera(kCam0)), radius_)).contains(stranger));
}

TEST_F(PointsByPlaceTest, OfNoPointsOrNoTracksThereAreNone) {
  const TrackGrid none(camera(kCam0), [](const ServerTrack&) { return false; });
  EXPECT_TRUE(PointsByPlace(points()).near_tracks(camera(kCam0), none, radius_).empty());
  EXPECT_TRUE(PointsByPlace({}).near_tracks(camera(kCam0), all_tracks(camera(kCam0)), radius_).empty());
}

TEST_F(PointsByPlaceTest, AGridVisitsAllThatAreNear) {
  const MapCamera& c = camera(kCam0);
  const TrackGrid grid = all_tracks(c);
  for (const double radius_px : {0.5, 6.0, 40.0}) {
    for (const Eigen::Vector2d& px : {Eigen::Vector2d(-50, 100), Eigen::Vector2d(320, 240), Eigen::Vector2d(637, 5)}) {
      std::set<TrackId> visited, expected;
      grid.near(px, radius_px, [&](const TrackGrid::InGrid& t) { visited.insert(t.track->id); });
      for (const auto& [id, t] : c.tracks) {
        const Eigen::Vector2d off = t.seen.back().undistorted_px.cast<double>() - px;
        if (off.cwiseAbs().maxCoeff() <= radius_px) expected.insert(id);
      }
      EXPECT_TRUE(std::ranges::includes(visited, expected));
      const bool within = std::ranges::any_of(c.tracks, [&](const auto& t) {
        return (t.second.seen.back().undistorted_px.template cast<double>() - px).norm() <= radius_px;
      });
      EXPECT_EQ(grid.any_near(px, radius_px, radius_px), within);
      EXPECT_EQ(grid.any_near(px, radius_px, 1e3), !visited.empty());
    }
  }
}

}  // namespace
}  // namespace coslam::points_by_place_test
