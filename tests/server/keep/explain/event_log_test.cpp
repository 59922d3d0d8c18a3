// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/explain/event_log.h"

#include <gmock/gmock.h>

#include <cmath>
#include <string>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::explain::event_log_test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kHeader = "t_s,set,kind,why,map,from,point,other,camera,track,to,a,b\n";

class EventLogTest : public ::testing::Test {
 protected:
  EventLog read(const std::string& rows) const { return read_event_log(temp_.write("events.csv", kHeader + rows)); }
  // Why a file with this row is refused; empty: it is not.
  std::string problem(const std::string& row) const {
    return test::error_of<UserError>([&] { read(row + "\n"); });
  }
  const test::TempFolder temp_;
};

TEST_F(EventLogTest, EventsAreFoundByWhatTheyAreAbout) {
  const EventLog log = read(
      "0.0,0,camera_joined,hello,,,,,left,,,,\n"
      "1.0,9,point_made,two_cameras_now,1,,3,,,,static,2,0.01\n"
      "1.0,9,track_bound,made_from_it,1,,3,,left,17,resting,,\n"
      "2.0,19,point_fused,one_corner,1,,3,4,,,,0.5,0.9\n"
      "3.0,29,map_moved,adjusted,1,,,,,,,12,300\n"
      "4.0,39,end,run_is_over,,,,,,,,,\n");
  EXPECT_EQ(log.events.size(), 5U);
  EXPECT_EQ(log.of_point.at(PointId(3)), (std::vector<At>{1, 2, 3}));
  EXPECT_EQ(log.of_point.at(PointId(4)), std::vector<At>{3});
  EXPECT_EQ(log.of_track.at({CameraId(0), TrackId(17)}), std::vector<At>{2});
  EXPECT_EQ(log.of_camera.at(CameraId(0)), std::vector<At>{0}) << "but not of its tracks";
  EXPECT_EQ(log.of_maps, std::vector<At>{4});
  EXPECT_EQ(log.name_of(CameraId(0)), "left");
  EXPECT_EQ(log.end, EventLog::End::kRunIsOver);
  EXPECT_EQ(log.end_ns, to_ns(4));
  EXPECT_TRUE(std::isnan(log.events[2].figures[0])) << "which the file does not hold";
}

TEST_F(EventLogTest, TimesOfAReplayAreItsOwnAndOfALiveRunFromItsFirstEvent) {
  EXPECT_EQ(read("5.0,0,camera_joined,hello,,,,,left,,,,\n").start_ns, 0);
  const EventLog live = read("1760000000.5,0,camera_joined,hello,,,,,left,,,,\n");
  EXPECT_EQ(live.start_ns, to_ns(1760000000.5));
  EXPECT_DOUBLE_EQ(live.seconds(live.start_ns + to_ns(2)), 2);
}

TEST_F(EventLogTest, NothingComesAfterTheEnd) {
  EXPECT_THAT(problem("4.0,39,end,run_is_over,,,,,,,,,\n5.0,40,camera_joined,hello,,,,,left,,,,"),
              HasSubstr("events.csv:3: not a line"));
  EXPECT_EQ(read("").end, EventLog::End::kNone);
  EXPECT_EQ(read("4.0,39,end,file_is_full,,,,,,,,,\n").end, EventLog::End::kFull);
}

TEST_F(EventLogTest, NamesThatNobodyKnowsAreRefused) {
  EXPECT_EQ(problem("1.0,9,point_made,two_cameras_now,1,,3,,,,static,2,0.01"), "");
  EXPECT_THAT(problem("1.0,9,point_born,two_cameras_now,1,,3,,,,static,2,0.01"), HasSubstr("events.csv:2"));
  EXPECT_THAT(problem("1.0,9,point_made,a_whim,1,,3,,,,static,2,0.01"), HasSubstr("events.csv:2"));
  EXPECT_THAT(problem("1.0,9,point_made,two_cameras_now,1,,3,,,,solid,2,0.01"), HasSubstr("events.csv:2"));
  EXPECT_THAT(problem("1.0,9,map_moved,adjusted,1,,,,,,static,12,300"), HasSubstr("events.csv:2")) << "a map has none";
}

TEST_F(EventLogTest, AnEventNamesWhatItIsAbout) {
  for (const char* row :
       {"1.0,9,point_made,two_cameras_now,1,,,,,,static,2,0.01", "1.0,9,point_became,stood_the_trial,1,,,,,,static,2,0",
        "1.0,9,point_removed,undetermined,1,,,,,,static,2,0", "1.0,9,point_fused,one_corner,1,,3,,,,,0.5,0.9",
        "1.0,9,point_fused,one_corner,1,,,4,,,,0.5,0.9", "1.0,9,point_fused,one_corner,1,,3,3,,,,0.5,0.9",
        "1.0,9,track_bound,made_from_it,1,,3,,,17,resting,,", "1.0,9,track_bound,made_from_it,1,,,,left,17,resting,,",
        "1.0,9,track_missed,outside_gate,1,,3,,,17,resting,1,3", "1.0,9,track_ended,image_ended,1,,3,,,17,resting,1,",
        "1.0,9,camera_joined,hello,,,,,,,,,", "1.0,9,camera_lost,no_pose,,,,,,,,3,4"}) {
    EXPECT_THAT(problem(row), HasSubstr("events.csv:2: not a line")) << row;
  }
  EXPECT_EQ(problem("1.0,9,point_fused,one_corner,1,,3,4,,,,0.5,0.9"), "");
  EXPECT_EQ(problem("1.0,9,track_ended,image_ended,1,,,,left,17,resting,1,"), "") << "it need not have had a point";
}

}  // namespace
}  // namespace coslam::explain::event_log_test
