// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/event_file.h"

#include <gmock/gmock.h>

#include <limits>
#include <sstream>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::event_file_test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kHeader = "t_s,set,kind,why,map,from,point,other,camera,track,to,a,b\n";

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

bool ignore(const EventRow& /*row*/) { return true; }

class EventFile : public ::testing::Test {
 protected:
  test::TempFolder temp_;
  std::filesystem::path file_ = temp_ / "events.csv";
};

TEST_F(EventFile, RoundTrip) {
  EventWriter writer(file_);
  writer.write({.t_ns = 500'000'000,
                .set = SetId(15),
                .kind = "point_fused",
                .why = "one_corner",
                .map = MapId(1),
                .from = MapId(2),
                .point = PointId(7),
                .other = PointId(4294967295),
                .camera = "cam0",
                .track = TrackId(9),
                .to = "static",
                .a = 0.25,
                .b = -1234.5});
  writer.write({.kind = kEventsEnd, .why = "run_is_over", .a = std::numeric_limits<double>::quiet_NaN()});
  writer.close();
  EXPECT_EQ(text_of(file_), std::string(kHeader) +
                                "0.500000000,15,point_fused,one_corner,1,2,7,4294967295,cam0,9,static,0.25,-1234.5\n"
                                "0.000000000,0,end,run_is_over,,,,,,,,,\n");
  EXPECT_EQ(writer.bytes(), std::filesystem::file_size(file_));
  int rows = 0;
  const EventFileReport report = for_each_event_row(file_, [&](const EventRow& r) {
    if (++rows > 1) {
      EXPECT_EQ(r.kind, kEventsEnd);
      EXPECT_EQ(r.point, PointId());
      EXPECT_FALSE(r.a || r.b);
      return true;
    }
    EXPECT_EQ(r.t_ns, 500'000'000);
    EXPECT_EQ(r.set, SetId(15));
    EXPECT_EQ(r.kind, "point_fused");
    EXPECT_EQ(r.why, "one_corner");
    EXPECT_EQ(r.map, MapId(1));
    EXPECT_EQ(r.from, MapId(2));
    EXPECT_EQ(r.point, PointId(7));
    EXPECT_EQ(r.other, PointId(4294967295));
    EXPECT_EQ(r.camera, "cam0");
    EXPECT_EQ(r.track, TrackId(9));
    EXPECT_EQ(r.to, "static");
    EXPECT_EQ(r.a, 0.25);
    EXPECT_EQ(r.b, -1234.5);
    return true;
  });
  EXPECT_EQ(rows, 2);
  EXPECT_EQ(report.rows, 2);
  EXPECT_FALSE(report.cut);
}

TEST_F(EventFile, NamesFileAndLine) {
  const auto error = [&](const std::string& text) {
    const auto file = temp_.write("t.csv", text);
    return test::error_of<UserError>([&] { for_each_event_row(file, ignore); });
  };
  const std::string good = "1,2,point_made,start_of_map,1,,3,,,,trial,5,\n";
  EXPECT_EQ(error(kHeader + good), "");
  EXPECT_THAT(error("t_s,kind\n"), HasSubstr("t.csv:1: the header"));
  for (const char* bad : {"1,2,point_made,why,1,,3,,,,trial,5", "1,2,point_made,why,1,,3,,,,trial,5,,6",
                          "x,2,point_made,why,1,,3,,,,trial,5,", "1,-2,point_made,why,1,,3,,,,trial,5,",
                          "1,2,point_made,why,1,,4294967296,,,,trial,5,", "1,2,point_made,why,1,,3,,,,trial,five,",
                          "1,2,,why,1,,3,,,,trial,5,", ""}) {
    EXPECT_THAT(error(kHeader + good + bad + "\n" + good), HasSubstr("t.csv:3: not a line")) << bad;
  }
  EXPECT_THAT(error(""), HasSubstr("cannot be read"));
  const auto unknown = temp_.write("t.csv", kHeader + good);
  EXPECT_THAT(test::error_of<UserError>([&] { for_each_event_row(unknown, [](const EventRow&) { return false; }); }),
              HasSubstr("t.csv:2: not a line"));
}

TEST_F(EventFile, LeavesOutALineThatWasCutOff) {
  const std::string line = "1,2,point_made,start_of_map,1,,3,,,,trial,5,";
  const auto cut = temp_.write("t.csv", kHeader + line + "\n" + line.substr(0, 12));
  const EventFileReport report = for_each_event_row(cut, ignore);
  EXPECT_EQ(report.rows, 1);
  EXPECT_TRUE(report.cut);
}

}  // namespace
}  // namespace coslam::event_file_test
