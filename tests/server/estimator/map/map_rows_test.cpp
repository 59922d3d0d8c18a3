// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/map_rows.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.h"
#include "server/estimator/map/edit.h"
#include "server/estimator/map/serialise.h"
#include "tests/support/map_checks.h"
#include "tests/support/sim_map.h"
#include "tests/support/temp_folder.h"

// Which rows are written when, and rows that are not ours. Random maps are in random_edits_test.cpp, whole files of
// older versions in keep/map_file_versions_test.cpp.
namespace coslam::map_rows_test {
namespace {

using testing::HasSubstr;

constexpr CameraId kCam0(0);

class MapRowsTest : public testing::Test {
 protected:
  MapRowsTest() {
    sim_.advance(4);
    sim_.add_points();
    rows_.changes(sim_.map);
  }
  // Keys of the rows that change in a table now; of those removed and of the others.
  std::set<std::int64_t> changed(const std::string& table, bool removed = false) {
    std::set<std::int64_t> keys;
    for (const Row& row : rows_.changes(sim_.map)) {
      if (row.table == table && row.bytes.empty() == removed) keys.insert(row.key);
    }
    return keys;
  }
  const MapPoint& any_point() const { return sim_.map.points().begin()->second; }

  const test::SimWorld world_{{.points = 40}};
  test::SimMap sim_{world_, test::paths_side_by_side(2)};
  MapRows rows_;
};

TEST_F(MapRowsTest, WhatDidNotChangeIsNotWrittenAgain) {
  std::set<std::string> tables;
  for (const Row& row : rows_.changes(sim_.map)) tables.insert(row.table);
  EXPECT_EQ(tables, (std::set<std::string>{"camera", "state"})) << "which are small";
}

TEST_F(MapRowsTest, APointThatMovedOrWentIsWritten) {
  const MapPoint& p = any_point();
  const auto key = static_cast<std::int64_t>(p.id.value);
  sim_.shift(p, {0.1, 0, 0});
  EXPECT_EQ(changed("point"), std::set{key});
  EXPECT_TRUE(changed("point").empty());
  sim_.edit.remove_point(p, Why::kTooFewViews);
  EXPECT_EQ(changed("point", true), std::set{key});
  EXPECT_TRUE(changed("point", true).empty()) << "once";
}

TEST_F(MapRowsTest, FramesAreWrittenWhenTheyComeChangeAndGo) {
  sim_.advance(1);
  EXPECT_EQ(changed("frame"), (std::set<std::int64_t>{4, (std::int64_t{1} << 32) + 4})) << "one of each camera";
  const MapCamera& camera = sim_.map.camera(kCam0);
  sim_.edit.adjust_pose(camera, *camera.frame_at(SetId(2)), test::looking({1, 0, 0}));
  EXPECT_EQ(changed("frame"), std::set<std::int64_t>{2});
  sim_.edit.take_frames(camera, SetId(4), {SetId(1)});
  EXPECT_EQ(changed("frame", true), (std::set<std::int64_t>{0, 2, 3}));
  sim_.edit.forget_frame(camera, SetId(1));
  sim_.advance(1);
  const std::vector<Row> rows = rows_.changes(sim_.map);
  const auto gone = [](const Row& r) { return r.table == "frame" && r.bytes.empty(); };
  EXPECT_EQ(std::ranges::count_if(rows, gone), 1) << "the oldest, whatever came behind";
}

TEST_F(MapRowsTest, APathThatLeftIsRemoved) {
  const PointId id = any_point().id;
  sim_.edit.record_motion(id, {sim_.set.id, sim_.set.t_ns, {}});
  EXPECT_EQ(changed("motion"), std::set{static_cast<std::int64_t>(id.value)});
  sim_.advance(1);
  sim_.edit.take_motions(sim_.set.id);
  EXPECT_EQ(changed("motion", true), std::set{static_cast<std::int64_t>(id.value)});
}

TEST_F(MapRowsTest, AllIsWrittenOnceMoreForAnOlderFile) {
  sim_.edit.record_motion(any_point().id, {sim_.set.id, sim_.set.t_ns, {}});
  const std::size_t points = sim_.map.points().size();
  rows_.changes(sim_.map);
  rows_.write_all_again();
  Tables tables;
  for (Row& row : rows_.changes(sim_.map)) tables[row.table][row.key] = std::move(row.bytes);
  EXPECT_EQ(tables.at("point").size(), points);
  EXPECT_EQ(tables.at("frame").size(), 8U);
  EXPECT_EQ(tables.at("motion").size(), 1U);
  MapEdit read{MapConfig()};
  read.restore(tables);
  EXPECT_EQ(test::Difference(test::Compared::kKept).of(read.map(), sim_.map), "");
  EXPECT_TRUE(changed("point").empty());
}

TEST_F(MapRowsTest, NobodyIsAliveInWhatWasRead) {
  Tables tables;
  for (Row& row : MapRows().changes(sim_.map)) tables[row.table][row.key] = std::move(row.bytes);
  MapEdit read{MapConfig()};
  read.restore(tables);
  for (const MapCamera& c : read.map().cameras()) EXPECT_FALSE(c.alive);
}

// Why rows cannot be read as those of a version.
std::string problem(const Tables& tables, int version = kRowsVersion) {
  return test::error_of<UserError>([&] { MapEdit(MapConfig()).restore(tables, version); });
}
std::int64_t key_of(StateRow row) { return static_cast<std::int64_t>(row); }

// A state of this version with another time between sets and another next map.
Tables state(double set_interval_s, std::uint32_t next_map) {
  return {
      {"state",
       {{key_of(StateRow::kMap), octets_of(std::set<MapId>(), std::vector<KeyFrame>(), std::set<ImageKey>(),
                                           std::set<PointId>(), std::vector<PointId>(), std::uint32_t{1}, next_map,
                                           MapEpoch(), SetId(), TimeNs{0}, set_interval_s, std::vector<TimeNs>())}}}};
}

TEST(ForeignRows, NoneAreAnEmptyMap) {
  EXPECT_EQ(problem({}), "");
  EXPECT_EQ(problem({}, 1), "");
  EXPECT_EQ(problem({{"point", {}}, {"nobody_knows", {{1, "x"}}}}), "") << "other tables are others'";
}

TEST(ForeignRows, APointNeedsItsMapAndItsNumber) {
  MapPoint point;
  point.id = PointId(1);
  EXPECT_THAT(problem({{"point", {{1, octets_of(point)}}}}), HasSubstr("a point of no number"));
  Tables tables = state(0.05, 2);
  point.id = PointId();
  point.map = MapId(1);
  tables["point"][0] = octets_of(point);
  EXPECT_THAT(problem(tables), HasSubstr("point 0: id is another than its number"));
}

TEST(ForeignRows, AFrameNeedsItsCamera) {
  EXPECT_THAT(problem({{"frame", {{0, octets_of(FramePose())}}}}), HasSubstr("a frame of no camera"));
  EXPECT_THAT(problem({{"frame", {{-1, octets_of(FramePose())}}}}), HasSubstr("a frame of no camera"));
}

TEST(ForeignRows, CamerasAreThereWithoutGaps) {
  MapCamera camera;
  camera.id = CameraId(3);
  EXPECT_THAT(problem({{"camera", {{3, octets_of(camera)}}}}), HasSubstr("lacks a camera"));
}

TEST(ForeignRows, BeforeVersion3LensesAndPastsWereApart) {
  const std::vector<LensCorrection> lens(1);
  const std::vector<PastFramesCount> past(1);
  EXPECT_THAT(problem({{"state", {{key_of(StateRow::kLenses), octets_of(lens)}}}}, 2),
              HasSubstr("a lens or a past of no camera"));
  const std::string with_past = octets_of(std::vector<MapMove>(), TimeNs{0}, past);
  EXPECT_THAT(problem({{"state", {{key_of(StateRow::kPast), with_past}}}}, 2),
              HasSubstr("a lens or a past of no camera"));
  const std::string none = octets_of(std::vector<MapMove>(), TimeNs{0}, std::vector<PastFramesCount>());
  EXPECT_EQ(problem({{"state", {{key_of(StateRow::kPast), none}}}}, 2), "");
}

TEST(ForeignRows, TheTimeBetweenSetsDividesTimes) {
  EXPECT_EQ(problem(state(0.05, 1)), "");
  for (const double interval_s : {0.0, -1.0, 1e-9, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(problem(state(interval_s, 1)), HasSubstr("a state that cannot be")) << interval_s;
  }
  EXPECT_THAT(problem(state(0.05, 0)), HasSubstr("a state that cannot be")) << "0 is no map";
}

TEST(ForeignRows, TheStateNamesWhatIsThere) {
  const auto with = [](const std::set<ImageKey>& images, const std::set<PointId>& untracked, TimeNs now_ns) {
    return problem(
        {{"state",
          {{key_of(StateRow::kMap), octets_of(std::set<MapId>(), std::vector<KeyFrame>(), images, untracked,
                                              std::vector<PointId>(), std::uint32_t{1}, std::uint32_t{1}, MapEpoch(),
                                              SetId(5), now_ns, 0.05, std::vector<TimeNs>())}}}});
  };
  EXPECT_EQ(with({}, {}, 0), "");
  EXPECT_THAT(with({{SetId(2), kCam0}}, {}, 0), HasSubstr("a key image is of no camera, or to come"));
  EXPECT_THAT(with({{SetId(6), kCam0}}, {}, 0), HasSubstr("a key image is of no camera, or to come"));
  EXPECT_THAT(with({}, {PointId(4)}, 0), HasSubstr("untracked_points names point 4, which is not there"));
  EXPECT_THAT(with({}, {}, std::numeric_limits<TimeNs>::max()), HasSubstr("its time is none"));
}

TEST(ForeignRows, MovesAreSimilaritiesOfMapsThatWere) {
  const auto moved = [](const MapMove& move) {
    Tables tables = state(0.05, 3);
    tables["state"][key_of(StateRow::kPast)] = octets_of(std::vector{move}, TimeNs{0});
    return problem(tables);
  };
  EXPECT_EQ(moved({MapId(2), MapId(1), Similarity3()}), "");
  EXPECT_THAT(moved({MapId(3), MapId(1), Similarity3()}), HasSubstr("moves.from is a map that was never there"));
  EXPECT_THAT(moved({MapId(2), MapId(1), {-1, Eigen::Quaterniond::Identity(), {0, 0, 0}}}),
              HasSubstr("moves.into_from_from is no similarity"));
}

}  // namespace
}  // namespace coslam::map_rows_test
