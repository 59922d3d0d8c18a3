// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/validate.h"

#include <gmock/gmock.h>

#include <limits>

#include "common/base/error.h"
#include "server/estimator/map/past.h"
#include "server/estimator/map/serialise.h"
#include "tests/support/sim_map.h"
#include "tests/support/temp_folder.h"

namespace coslam {
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
}  // namespace coslam
