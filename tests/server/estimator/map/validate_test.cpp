// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/validate.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <limits>

#include "common/base/error.h"
#include "server/estimator/map/past.h"
#include "server/estimator/map/serialise.h"
#include "tests/support/sim_map.h"
#include "tests/support/temp_folder.h"

namespace coslam::validate_test {
namespace {

using testing::HasSubstr;

class SoundTest : public testing::Test {
 protected:
  SoundTest() {
    sim_.ingest();
    sim_.place_truly();
    sim_.add_points();
    sim_.advance();
    for (Row& row : MapRows().changes(sim_.map)) tables_[row.table][row.key] = std::move(row.bytes);
  }
  // What is wrong with the rows; empty: nothing.
  std::string problem() const {
    return test::error_of<UserError>([this] { MapEdit(MapConfig{}).restore(tables_); });
  }
  // The last row of a table gets another number.
  void renumber(const std::string& table, std::int64_t by) {
    auto row = tables_.at(table).extract(std::prev(tables_.at(table).end()));
    row.key() += by;
    tables_.at(table).insert(std::move(row));
  }

  const test::SimWorld world_{{.points = 30}};
  test::SimMap sim_{world_, test::paths_side_by_side(2)};
  Tables tables_;
};

TEST_F(SoundTest, AMapOfOursIs) {
  EXPECT_EQ(problem(), "");
  validate(sim_.map);
}

TEST_F(SoundTest, RowsAreWhatTheirNumbersSay) {
  const Tables good = tables_;
  renumber("frame", 1);
  EXPECT_THAT(problem(), HasSubstr("a frame of no camera"));
  tables_ = good;
  tables_.at("camera").erase(1);
  EXPECT_THAT(problem(), HasSubstr("of no camera"));
  tables_ = good;
  tables_.at("point").erase(tables_.at("point").begin());
  EXPECT_THAT(problem(), HasSubstr("is bound to a point that does not know of it"));
  tables_ = good;
  tables_.at("state").erase(static_cast<std::int64_t>(StateRow::kMap));
  EXPECT_THAT(problem(), HasSubstr("the map file has a point of no number"));
}

TEST_F(SoundTest, NoRowEndsEarly) {
  for (const auto& [table, rows] : Tables(tables_)) {
    const Tables good = tables_;
    std::string& row = tables_.at(table).begin()->second;
    row.pop_back();
    EXPECT_THAT(problem(), HasSubstr("is not what it should be")) << table;
    tables_ = good;
  }
}

TEST_F(SoundTest, ThePastIsOfThisMap) {
  const auto wrong = [this](const auto& block) {
    return test::error_of<UserError>([&] { validate(block, sim_.map); });
  };
  PastFrames frames{{}, CameraId(1), {FramePose{SetId(0), FrameId(0), 5, sim_.id, {}, false, {}, 0}}};
  EXPECT_EQ(wrong(frames), "");
  frames.frames[0].capture_ns = std::numeric_limits<TimeNs>::max();
  EXPECT_THAT(wrong(frames), HasSubstr("past_frame: frames.capture_ns is out of time"));
  frames.camera = CameraId(2);
  EXPECT_THAT(wrong(frames), HasSubstr("camera is a camera that is not there"));
  PastPlaces places{{}, {PastPlace{.point = PointId(1), .map = sim_.id}}};
  EXPECT_EQ(wrong(places), "");
  places.places[0].p_in_cam.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(wrong(places), HasSubstr("past_place: places.p_in_cam is not finite"));
  EXPECT_THAT(wrong(PastPlaces{}), HasSubstr("it has no places"));
}

// Rows of a map of ours, of which one value is changed at a time.
class HostileRows : public SoundTest {
 protected:
  // Problem of the rows when the first row of a table holds another value.
  template <class Value>
  std::string with(const char* table, const std::function<void(Value&)>& change) const {
    Tables tables = tables_;
    std::string& octets = tables.at(table).begin()->second;
    Value value;
    read_octets(octets, value);
    change(value);
    octets = octets_of(value);
    return test::error_of<UserError>([&] { MapEdit(MapConfig{}).restore(tables); });
  }
  std::string with_camera(const std::function<void(MapCamera&)>& change) const { return with("camera", change); }
  std::string with_frame(const std::function<void(FramePose&)>& change) const { return with("frame", change); }
  std::string with_point(const std::function<void(MapPoint&)>& change) const { return with("point", change); }

  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kFar = 1e12;
};

TEST_F(HostileRows, ACameraIsOneThatCanBe) {
  EXPECT_EQ(with_camera([](MapCamera&) {}), "");
  for (const char* name : {"", ".hidden", "a/b", "a b", "\x7f", "012345678901234567890123456789012"}) {
    EXPECT_THAT(with_camera([&](MapCamera& c) { c.name = name; }), HasSubstr("name of a file")) << name;
  }
  EXPECT_THAT(with_camera([](MapCamera& c) { c.id = CameraId(1); }), HasSubstr("lacks a camera"));
  EXPECT_THAT(with_camera([](MapCamera& c) { c.model.fx = 0; }), HasSubstr("model is no calibration"));
  EXPECT_THAT(with_camera([](MapCamera& c) { c.lens.values[0] = kFar; }), HasSubstr("lens is too far away"));
  EXPECT_THAT(with_camera([](MapCamera& c) { c.lens.values[0] = 3; }), HasSubstr("lens cannot be"));
  EXPECT_THAT(with_camera([](MapCamera& c) { c.sigma_px = -1; }), HasSubstr("sigma_px is out of range"));
  EXPECT_THAT(with_camera([](MapCamera& c) { c.sigma_px = kNan; }), HasSubstr("sigma_px is no number that can be"));
  EXPECT_THAT(with_camera([](MapCamera& c) { c.scene_depth = -1; }), HasSubstr("scene_depth is out of range"));
  EXPECT_THAT(with_camera([](MapCamera& c) { c.frame_interval_s = 0; }), HasSubstr("frame_interval_s"));
  EXPECT_THAT(with_camera([](MapCamera& c) { c.map = MapId(77); }), HasSubstr("map is a map that was never there"));
  EXPECT_THAT(with_camera([](MapCamera& c) { c.run_since = SetId(9999); }), HasSubstr("frame set of the future"));
  EXPECT_THAT(with_camera([](MapCamera& c) { c.moved.scale = 0; }), HasSubstr("moved is no similarity"));
  EXPECT_THAT(with_camera([](MapCamera& c) { c.cam_from_rig.rotation.coeffs() *= 2; }), HasSubstr("is no pose"));
  EXPECT_THAT(with_camera([](MapCamera& c) { c.clock_offset_ns = std::numeric_limits<TimeNs>::min(); }),
              HasSubstr("clock_offset_ns is out of time"));
}

TEST_F(HostileRows, ThePastOfACameraAddsUp) {
  const auto past = [&](const std::function<void(PastFramesCount&)>& change) {
    return with_camera([&](MapCamera& c) { change(c.past); });
  };
  EXPECT_THAT(past([](PastFramesCount& p) { p.frames = -1; }), HasSubstr("more placed than frames"));
  EXPECT_THAT(past([](PastFramesCount& p) { p.placed[MapId(1)] = 1; }), HasSubstr("more placed than frames"));
  EXPECT_THAT(past([](PastFramesCount& p) { p.placed[MapId(1)] = -1; }), HasSubstr("more placed than frames"));
  EXPECT_THAT(past([](PastFramesCount& p) { p.placed[MapId(77)] = 0; }), HasSubstr("never there"));
  EXPECT_THAT(past([](PastFramesCount& p) { p.lost.emplace_back(0, std::numeric_limits<TimeNs>::max()); }),
              HasSubstr("past.lost is out of time"));
  EXPECT_THAT(past([](PastFramesCount& p) { p.until = SetId(9999); }), HasSubstr("frame set of the future"));
  EXPECT_EQ(past([](PastFramesCount& p) {
              p.frames = 2;
              p.placed[MapId(1)] = 2;
            }),
            "");
}

TEST_F(HostileRows, ATrackIsSeenInTheOrderOfTime) {
  const auto track = [&](const std::function<void(ServerTrack&)>& change) {
    return with_camera([&](MapCamera& c) { change(c.tracks.begin()->second); });
  };
  EXPECT_THAT(track([](ServerTrack& t) { t.id.value += 1000; }), HasSubstr("has another id"));
  EXPECT_THAT(track([](ServerTrack& t) { t.seen.push_back(t.seen.front()); }), HasSubstr("goes back in time"));
  EXPECT_THAT(track([](ServerTrack& t) { t.seen.back().undistorted_px.x() = std::nanf(""); }),
              HasSubstr("undistorted_px is not finite"));
  EXPECT_THAT(track([](ServerTrack& t) { t.seen.back().undistorted_px.x() = 1e12F; }), HasSubstr("is too far away"));
  EXPECT_THAT(track([](ServerTrack& t) { t.motion = static_cast<TrackMotion>(9); }), HasSubstr("motion is of no kind"));
  EXPECT_THAT(track([](ServerTrack& t) { t.point = PointId(9999); }), HasSubstr("does not know of it"));
  EXPECT_THAT(track([](ServerTrack& t) { t.co_moving_since = SetId(9999); }), HasSubstr("frame set of the future"));
}

TEST_F(HostileRows, AFrameIsOneThatCanBe) {
  EXPECT_THAT(with_frame([](FramePose& f) { f.set.value += 1; }), HasSubstr("a frame of no camera"));
  EXPECT_THAT(with_frame([](FramePose& f) { f.map = MapId(77); }), HasSubstr("frame 0 of camera 0: map is a map"));
  EXPECT_THAT(with_frame([](FramePose& f) { f.cam_from_world.translation.x() = kNan; }), HasSubstr("is no pose"));
  EXPECT_THAT(with_frame([](FramePose& f) { f.cam_from_world.translation.x() = kFar; }), HasSubstr("is no pose"));
  EXPECT_THAT(with_frame([](FramePose& f) { f.cam_from_world.rotation.coeffs().setZero(); }), HasSubstr("is no pose"));
  EXPECT_THAT(with_frame([](FramePose& f) { f.capture_ns = std::numeric_limits<TimeNs>::min(); }),
              HasSubstr("capture_ns is out of time"));
  EXPECT_THAT(with_frame([](FramePose& f) { f.zoom_taken_out = std::nanf(""); }), HasSubstr("zoom_taken_out"));
}

TEST_F(HostileRows, APointIsOneThatCanBe) {
  EXPECT_EQ(with_point([](MapPoint&) {}), "");
  EXPECT_THAT(with_point([](MapPoint& p) { p.map = MapId(); }), HasSubstr("point 1: map is none"));
  EXPECT_THAT(with_point([](MapPoint& p) { p.map = MapId(77); }), HasSubstr("map is a map that was never there"));
  EXPECT_THAT(with_point([](MapPoint& p) { p.position.y() = kNan; }), HasSubstr("position is not finite"));
  EXPECT_THAT(with_point([](MapPoint& p) { p.position.y() = kFar; }), HasSubstr("position is too far away"));
  EXPECT_THAT(with_point([](MapPoint& p) { p.covariance(0, 1) = kNan; }), HasSubstr("covariance is not finite"));
  EXPECT_EQ(with_point([](MapPoint& p) { p.covariance *= kFar; }), "") << "of a point about which little is known";
  EXPECT_THAT(with_point([](MapPoint& p) { p.phase = static_cast<PointPhase>(9); }), HasSubstr("phase is of no kind"));
  EXPECT_THAT(with_point([](MapPoint& p) { p.last_seen = SetId(9999); }), HasSubstr("frame set of the future"));
  EXPECT_THAT(with_point([](MapPoint& p) { p.first_ns = std::numeric_limits<TimeNs>::max(); }),
              HasSubstr("first_ns is out of time"));
  EXPECT_THAT(with_point([](MapPoint& p) { p.updated_from.resize(3, Eigen::Vector3d::Zero()); }),
              HasSubstr("updated_from has more cameras than there are"));
}

TEST_F(HostileRows, WhatAPointNamesIsThere) {
  EXPECT_THAT(with_point([](MapPoint& p) {
                p.bound.push_back({CameraId(9), TrackId(1)});
              }),
              HasSubstr("bound.camera is a camera that is not there"));
  EXPECT_THAT(with_point([](MapPoint& p) {
                p.bound.push_back({CameraId(0), TrackId(9999)});
              }),
              HasSubstr("bound names track 9999, which does not know of it"));
  EXPECT_THAT(with_point([](MapPoint& p) { p.bound.push_back(p.bound.front()); }),
              HasSubstr("is bound to a point that does not know of it"))
      << "twice";
  EXPECT_THAT(with_point([](MapPoint& p) { p.bound.clear(); }), HasSubstr("is bound to a point that does not know"));
  EXPECT_THAT(with_point([](MapPoint& p) {
                p.key_observations.push_back({SetId(9999), CameraId(0), {}, {0, 0}});
              }),
              HasSubstr("key_observations.set is a frame set of the future"));
  EXPECT_THAT(with_point([](MapPoint& p) {
                p.key_observations.push_back({SetId(0), CameraId(9), {}, {0, 0}});
              }),
              HasSubstr("key_observations.camera is a camera that is not there"));
}

TEST_F(HostileRows, APathIsOfCamerasThatAreThere) {
  sim_.edit.record_motion(PointId(1), {SetId(0), 0, {{CameraId(1), {3, 4}}}});
  for (Row& row : MapRows().changes(sim_.map)) tables_[row.table][row.key] = std::move(row.bytes);
  using Path = std::vector<MotionSample>;
  const auto path = [&](const std::function<void(Path&)>& change) { return with<Path>("motion", change); };
  EXPECT_EQ(path([](Path&) {}), "");
  EXPECT_THAT(path([](Path& p) { p[0].seen[0].camera = CameraId(9); }),
              HasSubstr("motion 1: seen.camera is a camera that is not there"));
  EXPECT_THAT(path([](Path& p) { p[0].set = SetId(9999); }), HasSubstr("frame set of the future"));
  EXPECT_THAT(path([](Path& p) { p[0].seen[0].step_px.y() = std::nanf(""); }), HasSubstr("step_px is not finite"));
}

TEST_F(SoundTest, ArchivedPlacesAndFramesHoldSomething) {
  const auto wrong = [this](const auto& block) {
    return test::error_of<UserError>([&] { validate(block, sim_.map); });
  };
  EXPECT_THAT(wrong(PastFrames{{}, CameraId(0), {}}), HasSubstr("it has no frames"));
  PastFrames frames{{}, CameraId(0), {FramePose{SetId(0), FrameId(0), 5, MapId(9), {}, false, {}, 0}}};
  EXPECT_THAT(wrong(frames), HasSubstr("frames.map is a map that was never there"));
  PastPlaces places{{}, {PastPlace{.point = PointId(1), .camera = CameraId(9), .map = sim_.id}}};
  EXPECT_THAT(wrong(places), HasSubstr("places.camera is a camera that is not there"));
  places.places[0].camera = CameraId(1);
  EXPECT_EQ(wrong(places), "");
  places.put.shifted_ns = std::numeric_limits<TimeNs>::max();
  EXPECT_THAT(wrong(places), HasSubstr("put.shifted_ns is out of time"));
}

// A count of which there are not so many octets takes no memory, and true is 1.
TEST(OctetsOfRows, CountsAreNotBelieved) {
  const auto refused = [](const std::string& octets, auto value) {
    return test::error_of<UserError>([&] { read_octets(octets, value); });
  };
  const std::string many = octets_of(std::uint64_t{1} << 40U);
  EXPECT_THAT(refused(many, std::vector<double>()), HasSubstr("not what it should be"));
  EXPECT_THAT(refused(many, std::string()), HasSubstr("not what it should be"));
  EXPECT_THAT(refused("\2", false), HasSubstr("not what it should be"));
  EXPECT_EQ(refused("\1", false), "");
  std::vector<double> none{1};
  read_octets(octets_of(std::vector<double>()), none);
  EXPECT_TRUE(none.empty());
  // The number of frames of a past block, in four octets.
  EXPECT_THAT(test::error_of<UserError>([] {
                past_frames_of(octets_of(std::uint64_t{0}, TimeNs{0}, CameraId(0), std::uint32_t{0xffffffff}));
              }),
              HasSubstr("not what it should be"));
}

}  // namespace
}  // namespace coslam::validate_test
