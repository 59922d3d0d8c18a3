// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/result.h"

#include <gmock/gmock.h>

#include <cstring>
#include <sstream>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::result_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const Eigen::Matrix3d kCovariance = (Eigen::Matrix3d() << 4, 0.1, 0.2, 0.1, 5, 0.3, 0.2, 0.3, 7).finished();

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

class Result : public ::testing::Test {
 protected:
  test::TempFolder temp_;
  ResultFolder folder_{temp_ / "out"};
};

TEST_F(Result, PointsRoundTrip) {
  ResultPoint point;
  point.id = PointId(7);
  point.position = {1.25, -2, 1e-3};
  point.covariance = kCovariance;
  point.state = PointState::kUncertain;
  point.first_ns = 1'500'000'000;
  point.last_ns = 1403638518377829376;
  point.views = 12;
  PointWriter writer(folder_.points());
  writer.write(point);
  writer.close();
  EXPECT_EQ(text_of(folder_.points()),
            "id,x,y,z,cov_xx,cov_xy,cov_xz,cov_yy,cov_yz,cov_zz,state,first_t_s,last_t_s,views\n"
            "7,1.25,-2,0.001,4,0.1,0.2,5,0.3,7,uncertain,1.500000000,1403638518.377829376,12\n");
  const auto read = read_points(folder_.points());
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].id, point.id);
  EXPECT_EQ(read[0].position, point.position);
  EXPECT_EQ(read[0].covariance, point.covariance);
  EXPECT_EQ(read[0].state, point.state);
  EXPECT_EQ(read[0].last_ns, point.last_ns);
  EXPECT_EQ(read[0].views, 12);
}

TEST_F(Result, TracksRoundTrip) {
  TrackWriter writer(folder_.tracks("cam0"));
  writer.write({FrameId(10), 333'000'000, TrackId(5), {10.5, 20.25}, PointId(3), PointState::kDynamic});
  writer.write({FrameId(10), 333'000'000, TrackId(6), {0, 0}, PointId(), std::nullopt});
  writer.close();
  EXPECT_THAT(text_of(folder_.tracks("cam0")),
              StartsWith("frame,t_s,track,u,v,point,state\n10,0.333000000,5,10.500,20.250,3,dynamic\n"));
  std::vector<ResultTrackRow> rows;
  for_each_track_row(folder_.tracks("cam0"), [&](const ResultTrackRow& r) { rows.push_back(r); });
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].frame, FrameId(10));
  EXPECT_EQ(rows[0].t_ns, 333'000'000);
  EXPECT_EQ(rows[0].track, TrackId(5));
  EXPECT_EQ(rows[0].raw_px, Eigen::Vector2d(10.5, 20.25));
  EXPECT_EQ(rows[0].state, PointState::kDynamic);
  EXPECT_EQ(rows[1].state, std::nullopt);
  EXPECT_EQ(rows[1].point, PointId());
}

TEST_F(Result, DynamicAndGroupsRoundTrip) {
  DynamicWriter dynamic(folder_.dynamic());
  dynamic.write({500'000'000, PointId(9), {1, 2, 3}, kCovariance, 2});
  dynamic.close();
  int rows = 0;
  for_each_dynamic_row(folder_.dynamic(), [&](const ResultDynamicRow& r) {
    ++rows;
    EXPECT_EQ(r.id, PointId(9));
    EXPECT_EQ(r.position, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(r.covariance, kCovariance);
    EXPECT_EQ(r.views, 2);
  });
  EXPECT_EQ(rows, 1);

  GroupWriter groups(folder_.groups());
  groups.write({0, GroupId(1), {"cam0", "cam1"}});
  groups.write({5, GroupId(2), {}});
  groups.close();
  const auto read = read_groups(folder_.groups());
  ASSERT_EQ(read.size(), 2u);
  EXPECT_THAT(read[0].agents, ElementsAre("cam0", "cam1"));
  EXPECT_TRUE(read[1].agents.empty());
}

TEST_F(Result, ObjectsRoundTrip) {
  ObjectWriter writer(folder_.objects());
  writer.write({500'000'000, ObjectId(3), {1, 2, 3}, {0.5, 0, -1}, {0.25, 0.5, 2}, {PointId(9), PointId(12)}});
  writer.write({600'000'000, ObjectId(4), {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {}});
  writer.close();
  EXPECT_EQ(text_of(folder_.objects()),
            "t_s,object,x,y,z,vx,vy,vz,extent_x,extent_y,extent_z,members\n"
            "0.500000000,3,1,2,3,0.5,0,-1,0.25,0.5,2,9 12\n0.600000000,4,0,0,0,0,0,0,0,0,0,\n");
  std::vector<ResultObjectRow> rows;
  for_each_object_row(folder_.objects(), [&](const ResultObjectRow& r) { rows.push_back(r); });
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].t_ns, 500'000'000);
  EXPECT_EQ(rows[0].object, ObjectId(3));
  EXPECT_EQ(rows[0].position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(rows[0].velocity_per_s, Eigen::Vector3d(0.5, 0, -1));
  EXPECT_EQ(rows[0].extent, Eigen::Vector3d(0.25, 0.5, 2));
  EXPECT_THAT(rows[0].members, ElementsAre(PointId(9), PointId(12)));
  EXPECT_TRUE(rows[1].members.empty());
  const auto bad = temp_.write("bad.csv",
                               "t_s,object,x,y,z,vx,vy,vz,extent_x,extent_y,extent_z,members\n"
                               "0.5,3,1,2,3,0.5,0,-1,0.25,0.5,2,9 x\n");
  EXPECT_THAT(test::error_of<UserError>([&] { for_each_object_row(bad, [](const ResultObjectRow&) {}); }),
              HasSubstr("bad.csv:2: not a line"));
}

TEST_F(Result, ReadersNameFileAndLine) {
  const auto error = [&](const std::string& text) {
    const auto file = temp_.write("t.csv", text);
    return test::error_of<UserError>([&] { for_each_track_row(file, [](const ResultTrackRow&) {}); });
  };
  const std::string header = "frame,t_s,track,u,v,point,state\n";
  EXPECT_EQ(error(header + "\n"), "");
  EXPECT_THAT(error("frame,t_s\n"), HasSubstr("t.csv:1: the header"));
  for (const char* bad :
       {"1,0,2,3,4,5", "1,0,2,3,4,5,static,6", "1,0,2,3,4,5,still", "1,0,2,3,4,5,false", "-1,0,2,3,4,5,static",
        "1,x,2,3,4,5,static", "1,0,2,nan,4,5,static", "4294967296,0,2,3,4,5,static"}) {
    EXPECT_THAT(error(header + "1,0,2,3,4,5,static\n" + bad + "\n"), HasSubstr("t.csv:3: not a line")) << bad;
  }
  EXPECT_THAT(error(""), HasSubstr("cannot be read"));
}

TEST_F(Result, PlyHoldsTheStaticPoints) {
  std::vector<ResultPoint> points(3);
  points[0].position = {1, 2, 3};
  points[0].covariance = kCovariance;
  points[0].rgb = {200, 150, 100};
  points[1].state = PointState::kDynamic;
  write_ply(folder_.map(), points, LengthUnit::kMapUnits);
  const std::string text = text_of(folder_.map());
  const std::string end = "end_header\n";
  EXPECT_THAT(text, StartsWith("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(text, HasSubstr("; scale unknown: lengths are in units of the map\nelement vertex 2\n"));
  const std::string body = text.substr(text.find(end) + end.size());
  ASSERT_EQ(body.size(), 2u * 19u);
  float position[3], sigma = 0;
  std::memcpy(position, body.data(), 12);
  std::memcpy(&sigma, body.data() + 15, 4);
  EXPECT_THAT(position, ElementsAre(1, 2, 3));
  EXPECT_EQ(static_cast<unsigned char>(body[12]), 200);
  EXPECT_EQ(static_cast<unsigned char>(body[14]), 100);
  EXPECT_FLOAT_EQ(sigma, 4);  // sqrt(4 + 5 + 7)
}

TEST_F(Result, Json) {
  write_json(folder_.report(), {{"frames", 5}});
  EXPECT_EQ(read_json(folder_.report())["frames"], 5);
  const auto bad = temp_.write("bad.json", "{");
  EXPECT_THAT(test::error_of<UserError>([&] { read_json(bad); }), HasSubstr("bad.json: not valid JSON"));
}

TEST_F(Result, SaysWhatCannotBeWritten) {
  temp_.write("file", "");
  EXPECT_THAT(test::error_of<UserError>([&] { PointWriter(temp_ / "file/points.csv"); }),
              HasSubstr("points.csv: cannot be written"));
}

}  // namespace
}  // namespace coslam::result_test
