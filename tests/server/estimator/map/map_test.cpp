// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "server/estimator/map/edit.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

// Cameras, frame sets and tracks. Points are in map_points_test.cpp.
namespace coslam::map_test {
namespace {

// Measures the same standard deviation in so many frames that nothing else counts.
void measure_until_sure(MapEdit& edit, const MapCamera& camera, double sigma_px) {
  constexpr int kFrames = 400;
  for (int i = 0; i < kFrames; ++i) edit.measure_sigma(camera, sigma_px);
}

using test::PoseNear;
using test::SimilarityNear;
using test::VectorNear;

constexpr CameraId kCam0(0), kCam1(1);

// One frame set of one camera with these tracks.
FrameSet set_of(std::uint32_t set, const std::vector<std::uint32_t>& tracks, CameraId camera = kCam0) {
  CameraFrame cf{camera, {}, {}, {}};
  cf.frame.frame = FrameId(set);
  cf.frame.capture_ns = test::kPeriodNs * set;
  for (const std::uint32_t t : tracks) {
    cf.frame.tracks.push_back({TrackId(t), Eigen::Vector2f(static_cast<float>(t), static_cast<float>(set))});
  }
  return {SetId(set), test::kPeriodNs * set, {cf}};
}

CameraModel wide(int width_px) {
  CameraModel model = test::sim_camera();
  model.width_px = width_px;
  return model;
}

class MapTest : public testing::Test {
 protected:
  MapTest() {
    edit_.add_camera("left", RunId(1), test::sim_camera());
    edit_.add_camera("right", RunId(2), test::sim_camera());
  }
  MapEdit edit_{MapConfig{}};
  const Map& map_ = edit_.map();
};

TEST_F(MapTest, NumbersCamerasInOrder) {
  ASSERT_EQ(map_.cameras().size(), 2U);
  EXPECT_EQ(map_.camera(kCam1).id, kCam1);
  EXPECT_EQ(map_.camera(kCam1).name, "right");
  EXPECT_EQ(map_.camera(kCam1).map, MapId());
}

// Whatever the rate is, what is to last a time lasts that long.
TEST_F(MapTest, CountsFramesByTheTimeBetweenThem) {
  EXPECT_EQ(map_.sets_in(0.5), 15U) << "30 a second as long as nothing is known";
  const auto ingest = [&](std::uint32_t set, TimeNs t_ns, bool right_too) {
    FrameSet both{SetId(set), t_ns, {}};
    for (const CameraId c : {kCam0, kCam1}) {
      if (c == kCam1 && !right_too) continue;
      both.frames.push_back({c, {}, {}, {}});
      both.frames.back().frame.capture_ns = t_ns;
    }
    edit_.ingest(both);
  };
  TimeNs t_ns = 0;
  for (std::uint32_t i = 0; i < 40; ++i, t_ns += to_ns(0.05))
    ingest(i, i == 30 ? t_ns + to_ns(0.004) : t_ns, i % 2 == 0);
  EXPECT_EQ(map_.sets_in(0.5), 10U);
  EXPECT_EQ(map_.sets_in(0.001), 1U);
  EXPECT_EQ(map_.camera(kCam0).frames_in(0.5), 10);
  EXPECT_EQ(map_.camera(kCam1).frames_in(0.5), 5) << "half the rate of the sets";
  EXPECT_EQ(map_.camera(kCam1).frames_in(0.1, 4), 4);
  t_ns += to_ns(3);  // a gap is no rate
  ingest(40, t_ns, true);
  EXPECT_EQ(map_.sets_in(0.5), 10U);
  int due = 0;
  for (std::uint32_t i = 41; i < 71; ++i) {
    t_ns += to_ns(0.1);
    ingest(i, t_ns, true);
    due += i > 60 && map_.every(0.5);
  }
  EXPECT_EQ(map_.sets_in(0.5), 5U) << "the newest count";
  EXPECT_EQ(due, 2);
}

TEST_F(MapTest, TracksStartGoOnAndEnd) {
  edit_.ingest(set_of(0, {1, 2}));
  edit_.ingest(set_of(1, {2, 3}));
  const MapCamera& c = map_.camera(kCam0);
  ASSERT_EQ(c.tracks.size(), 2U);
  EXPECT_EQ(c.tracks.at(TrackId(2)).seen.size(), 2U);
  EXPECT_EQ(c.tracks.at(TrackId(2)).seen.front().set, SetId(0));
  EXPECT_EQ(c.tracks.at(TrackId(2)).seen.back().undistorted_px, Eigen::Vector2f(2, 1));
  EXPECT_EQ(c.tracks.at(TrackId(3)).seen.size(), 1U);
  ASSERT_EQ(c.frames.size(), 2U);
  EXPECT_FALSE(c.frames.back().valid());
  EXPECT_EQ(map_.now(), SetId(1));
  EXPECT_EQ(map_.now_ns(), test::kPeriodNs);
}

TEST_F(MapTest, ACameraThatIsNotInASetKeepsItsTracks) {
  edit_.ingest(set_of(0, {1}, kCam0));
  edit_.ingest(set_of(1, {5}, kCam1));
  edit_.ingest(set_of(2, {1}, kCam0));
  EXPECT_EQ(map_.camera(kCam0).tracks.at(TrackId(1)).seen.size(), 2U);
  EXPECT_EQ(map_.camera(kCam0).frame_at(SetId(1)), nullptr);
  ASSERT_NE(map_.camera(kCam0).frame_at(SetId(2)), nullptr);
  EXPECT_EQ(map_.camera(kCam0).frame_at(SetId(2))->frame, FrameId(2));
  EXPECT_EQ(map_.camera(kCam0).frame_at(SetId(3)), nullptr);
}

TEST_F(MapTest, PatchesGoToTheirTracks) {
  FrameSet set = set_of(0, {1, 2});
  set.frames[0].patches = PatchReply{"left", RunId(1), FrameId(0), {{TrackId(2), {}}, {TrackId(9), {}}}};
  set.frames[0].patches->patches[0].grey.fill(7);
  edit_.ingest(set);
  const MapCamera& c = map_.camera(kCam0);
  EXPECT_FALSE(c.tracks.at(TrackId(1)).patch);
  ASSERT_TRUE(c.tracks.at(TrackId(2)).patch);
  EXPECT_EQ((*c.tracks.at(TrackId(2)).patch)[60], 7);
  EXPECT_EQ(c.tracks.size(), 2U) << "a patch for a track that ended starts none";
}

TEST_F(MapTest, ObservationsOfALongTrackAreBounded) {
  for (std::uint32_t i = 0; i < 3000; ++i) edit_.ingest(set_of(i, {1}));
  const auto& seen = map_.camera(kCam0).tracks.at(TrackId(1)).seen;
  EXPECT_LE(seen.size(), 300U);
  EXPECT_GE(seen.size(), 128U);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end(), [](const auto& a, const auto& b) { return a.set < b.set; }));
  EXPECT_EQ(seen.front().set, SetId(0)) << "the widest parallax is kept";
  for (std::uint32_t back = 0; back < 100; ++back) {
    EXPECT_EQ(seen[seen.size() - 1 - back].set, SetId(2999 - back)) << "the newest are all there";
  }
}

TEST_F(MapTest, RestartDropsTracksAndKeepsPoses) {
  edit_.ingest(set_of(0, {1, 2}));
  const MapCamera& c = map_.camera(kCam0);
  const MapId id = edit_.new_map(Why::kStartedAlone, 1);
  edit_.place(c, SetId(0), id, Rigid3(), Why::kStartedAlone);
  const MapPoint& p =
      edit_.create_point(id, {0, 0, 5}, Eigen::Matrix3d::Identity(), PointPhase::kStatic, Why::kStartOfMap);
  edit_.bind(p, kCam0, c.tracks.at(TrackId(1)), Why::kMadeFromIt);
  edit_.restart_camera(kCam0, RunId(77), test::sim_camera());
  EXPECT_EQ(c.run, RunId(77));
  EXPECT_TRUE(c.tracks.empty());
  EXPECT_TRUE(p.bound.empty());
  EXPECT_EQ(c.map, MapId());
  ASSERT_EQ(c.frames.size(), 1U);
  EXPECT_TRUE(c.frames[0].valid());
  edit_.ingest(set_of(1, {1}));  // the new run numbers its tracks anew
  EXPECT_EQ(c.tracks.at(TrackId(1)).seen.size(), 1U);
  EXPECT_EQ(c.tracks.at(TrackId(1)).point, PointId());
}

TEST_F(MapTest, ViewsAreThoseWithAPoseInTheMapAndSpread) {
  const MapId id = edit_.new_map(Why::kStartedAlone, 1), other = edit_.new_map(Why::kStartedAlone, 1);
  const MapCamera& c = map_.camera(kCam0);
  for (std::uint32_t i = 0; i < 30; ++i) {
    edit_.ingest(set_of(i, {1}));
    if (i == 3) continue;  // no pose
    edit_.place(c, SetId(i), i == 4 ? other : id, test::looking({0.1 * i, 0, 0}), Why::kStartedAlone);
  }
  const ServerTrack& track = c.tracks.at(TrackId(1));
  const std::vector<View> all = map_.views_of(c, track, 100);
  EXPECT_EQ(all.size(), 28U);
  const std::vector<View> few = map_.views_of(c, track, 5);
  ASSERT_EQ(few.size(), 5U);
  EXPECT_THAT(few.front().undistorted_px, VectorNear(Eigen::Vector2d(1, 0), 1e-9));
  EXPECT_THAT(few.back().undistorted_px, VectorNear(Eigen::Vector2d(1, 29), 1e-9));
  edit_.distrust_before(track, SetId(10));
  EXPECT_EQ(map_.views_of(c, track, 100).size(), 20U);
}

TEST_F(MapTest, GateIsGenerousButBounded) {
  const MapCamera& c = map_.camera(kCam0);
  measure_until_sure(edit_, c, 0.1);
  EXPECT_DOUBLE_EQ(map_.gate_sigma_px(c), 1.0);
  measure_until_sure(edit_, c, 0.8);
  EXPECT_DOUBLE_EQ(map_.gate_sigma_px(c), 2.0);
  measure_until_sure(edit_, c, 10);
  EXPECT_DOUBLE_EQ(map_.gate_sigma_px(c), 3.0);
  edit_.restart_camera(kCam0, RunId(3), wide(1280));
  EXPECT_DOUBLE_EQ(map_.gate_sigma_px(c), 6.0);
}

// Images so small that the largest believed noise is below the least gate.
TEST_F(MapTest, TheBoundOfTheGateWinsInASmallImage) {
  const MapCamera& c = map_.camera(kCam0);
  edit_.restart_camera(kCam0, RunId(3), wide(160));
  for (const double sigma_px : {0.1, 0.2, 0.5, 10.0}) {
    measure_until_sure(edit_, c, sigma_px);
    EXPECT_DOUBLE_EQ(map_.gate_sigma_px(c), 0.75) << sigma_px;
  }
  edit_.restart_camera(kCam0, RunId(4), wide(213));
  measure_until_sure(edit_, c, 0.2);
  EXPECT_DOUBLE_EQ(map_.gate_sigma_px(c), 3.0 * 213 / 640);
}

// Two maps with one camera and one point each, as truth has them.
class TwoMaps : public MapTest {
 protected:
  TwoMaps() : first_(edit_.new_map(Why::kStartedAlone, 1)), second_(edit_.new_map(Why::kStartedAlone, 1)) {
    for (const CameraId id : {kCam0, kCam1}) {
      const FrameSet set = set_of(id.value, {1}, id);
      edit_.ingest(set);
      const MapCamera& c = map_.camera(id);
      edit_.place(c, set.id, id == kCam0 ? first_ : second_, pose_, Why::kStartedAlone);
      const MapPoint& p = edit_.create_point(c.map, {1, 0, 5}, Eigen::Vector3d(1, 2, 3).asDiagonal(),
                                             PointPhase::kStatic, Why::kStartOfMap);
      edit_.bind(p, id, c.tracks.at(TrackId(1)), Why::kMadeFromIt);
    }
  }
  const MapPoint& point_of(CameraId id) const { return *map_.find(map_.camera(id).tracks.at(TrackId(1)).point); }
  const Rigid3 pose_ = test::looking({0.5, 0.1, 0}, 0.3);
  const Similarity3 move_{0.5, so3_exp({0.2, 1.0, -0.3}), {4, 5, 6}};
  MapId first_, second_;
};

TEST_F(TwoMaps, TransformMovesOneMapAndSaysSo) {
  const MapEpoch before = map_.epoch();
  edit_.transform(second_, move_, Why::kScaleKnown);
  EXPECT_GT(map_.epoch(), before);
  EXPECT_THAT(point_of(kCam0).position, VectorNear(Eigen::Vector3d(1, 0, 5), 1e-12));
  EXPECT_THAT(point_of(kCam1).position, VectorNear(move_ * Eigen::Vector3d(1, 0, 5), 1e-12));
  EXPECT_NEAR(point_of(kCam1).covariance.trace(), 0.25 * 6, 1e-12);
  EXPECT_THAT(map_.camera(kCam0).frames.back().cam_from_world, PoseNear(pose_, 1e-9, 1e-12));
  EXPECT_THAT(map_.camera(kCam1).frames.back().cam_from_world, PoseNear(transform_world(pose_, move_), 1e-7, 1e-12));
  EXPECT_THAT(map_.camera(kCam0).moved, SimilarityNear(Similarity3(), 1e-9, 1e-12, 1e-12));
  EXPECT_THAT(map_.camera(kCam1).moved, SimilarityNear(move_, 1e-7, 1e-12, 1e-12));
  edit_.transform(second_, move_, Why::kScaleKnown);
  EXPECT_THAT(map_.camera(kCam1).moved, SimilarityNear(move_ * move_, 1e-7, 1e-9, 1e-12));
}

TEST_F(TwoMaps, MergeMakesOneMap) {
  const MapEpoch before = map_.epoch();
  edit_.merge(second_, first_, move_);
  EXPECT_GT(map_.epoch(), before);
  EXPECT_EQ(point_of(kCam1).map, first_);
  EXPECT_EQ(map_.camera(kCam1).map, first_);
  EXPECT_EQ(map_.camera(kCam1).frames.back().map, first_);
  EXPECT_THAT(point_of(kCam1).position, VectorNear(move_ * Eigen::Vector3d(1, 0, 5), 1e-12));
  EXPECT_THAT(point_of(kCam0).position, VectorNear(Eigen::Vector3d(1, 0, 5), 1e-12));
}

}  // namespace
}  // namespace coslam::map_test
