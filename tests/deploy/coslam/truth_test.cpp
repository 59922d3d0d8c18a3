// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/truth.h"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "common/base/error.h"
#include "tests/support/matchers.h"
#include "tests/support/temp_folder.h"

namespace coslam::eval::truth_test {
namespace {

using test::VectorNear;
using ::testing::HasSubstr;

class Truth : public ::testing::Test {
 protected:
  SequenceAgent agent(const std::string& truth, const std::string& source = "") {
    SequenceAgent out;
    out.name = "left";
    out.truth = folder_.write("truth.txt", truth);
    out.source = (folder_ / source).string();
    return out;
  }
  void image(const std::string& name) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    cv::imwrite(folder_ / name, cv::Mat(24, 32, CV_8UC1, cv::Scalar(9)));
  }
  // Images at 1305031102.1, .2 and .3 s.
  std::string dated_source() {
    std::string list;
    for (const char* time : {"1305031102.100000", "1305031102.200000", "1305031102.300000"}) {
      image(std::string("tum/rgb/") + time + ".png");
      list += std::string(time) + " rgb/" + time + ".png\n";
    }
    folder_.write("tum/rgb.txt", list);
    return "tum";
  }
  test::TempFolder folder_;
};

TEST_F(Truth, TumInPlayedTime) {
  SequenceAgent a = agent("# t tx ty tz qx qy qz qw\n0.0 1 2 3 0 0 0 1\n0.5 2 2 3 0 0 0 1\n1.5 3 2 3 0 0 0 1\n");
  a.duration_s = 1.0;
  const Trajectory t = load_truth(a, 30);
  ASSERT_EQ(t.size(), 2U);
  EXPECT_EQ(t[1].t_ns, 500'000'000);
  EXPECT_THAT(t[1].cam_from_world.center(), VectorNear(Eigen::Vector3d(2, 2, 3), 1e-12));
}

TEST_F(Truth, TumMayBeWrittenInManyWays) {
  const std::string pose = " 1 2 3 0 0 0 1\n", commas = ",1,2,3,0,0,0,1\n", semicolons = ";1;2;3;0;0;0;1\n";
  for (const std::string& text :
       {"timestamp tx ty tz qx qy qz qw\n0.0" + pose + "1317000000.5" + pose, "0.0" + commas + "1317000000.5" + commas,
        "0.0" + semicolons + "1317000000.5" + semicolons, "0" + pose + "1317000000500000000" + pose,
        "0.0" + pose + "0.0" + pose + "1317000000.5" + pose}) {
    const Trajectory t = load_truth(agent(text), 30);
    ASSERT_EQ(t.size(), 2U) << text;
    EXPECT_EQ(t[1].t_ns, 1'317'000'000'500'000'000) << text;
    EXPECT_THAT(t[1].cam_from_world.center(), VectorNear(Eigen::Vector3d(1, 2, 3), 1e-12)) << text;
  }
}

TEST_F(Truth, OfTumInNanosecondsOfThePlayedTime) {
  const Trajectory t = load_truth(agent("0 1 2 3 0 0 0 1\n50000000 1 2 3 0 0 0 1\n"), 30);
  ASSERT_EQ(t.size(), 2U);
  EXPECT_EQ(t[1].t_ns, 50'000'000);
}

TEST_F(Truth, InUtcCountsFromWhereTheSourceDoes) {
  SequenceAgent a = agent(
      "1305031102.0500 0 0 0 0 0 0 1\n1305031102.1500 1 0 0 0 0 0 1\n1305031102.2500 2 0 0 0 0 0 1\n", dated_source());
  Trajectory t = load_truth(a, 30);
  ASSERT_EQ(t.size(), 3U);
  EXPECT_EQ(t[0].t_ns, -50'000'000);
  EXPECT_EQ(t[2].t_ns, 150'000'000);
  a.start_s = a.truth_start_s = 0.1;
  t = load_truth(a, 30);
  EXPECT_EQ(t[2].t_ns, 50'000'000) << "of the played time";
}

TEST_F(Truth, InUtcMeetsAVideoWithTimesBesideIt) {
  folder_.write("walk.mp4", "");
  folder_.write("walk.timestamps.csv", "1305031102.1\n1305031102.2\n");
  const Trajectory t = load_truth(agent("1305031102.1 0 0 0 0 0 0 1\n1305031102.2 1 0 0 0 0 0 1\n", "walk.mp4"), 30);
  ASSERT_EQ(t.size(), 2U);
  EXPECT_EQ(t[1].t_ns, 100'000'000);
}

TEST_F(Truth, PosesOfNanAreLeftOut) {
  const std::string some = "0.0 1 2 3 0 0 0 1\n0.1 nan nan nan nan nan nan nan\n0.2 2 2 3 0 0 0 1\n";
  const Trajectory t = load_truth(agent(some), 30);
  ASSERT_EQ(t.size(), 2U);
  EXPECT_EQ(t[1].t_ns, 200'000'000);
  const SequenceAgent none = agent("0.1 nan nan nan nan nan nan nan\n");
  EXPECT_THAT(test::error_of<UserError>([&] { load_truth(none, 30); }), HasSubstr("has no pose without NaN"));
}

TEST_F(Truth, OfAClockSinceTheMachineWasStartedCountsLikewise) {
  for (const char* name : {"a.png", "b.png"}) image(std::string("boot/") + name);
  folder_.write("boot/list.csv", "5461.6,a.png\n5461.7,b.png\n");
  const std::string written = "5461.6 0 0 0 0 0 0 1\n5461.7 1 0 0 0 0 0 1\n",
                    played = "0.0 0 0 0 0 0 0 1\n0.1 1 0 0 0 0 0 1\n";
  for (const std::string& text : {written, played}) {
    const Trajectory t = load_truth(agent(text, "boot/list.csv"), 30);
    ASSERT_EQ(t.size(), 2U);
    EXPECT_EQ(t[0].t_ns, 0);
    EXPECT_EQ(t[1].t_ns, 100'000'000);
  }
}

TEST_F(Truth, EurocIsOfTheBody) {
  const std::string text =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n"
      "1305031102100000000,1,2,3,0.7071067811865476,0,0,0.7071067811865476,0,0,0\n"
      "1305031102200000000,1,2,4,0.7071067811865476,0,0,0.7071067811865476,0,0,0\n";
  SequenceAgent a = agent(text, dated_source());
  a.calibration = folder_.write("sensor.yaml",
                                "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, 0, 0.5, 0, 1, 0, 0, "
                                "0, 0, 1, 0, 0, 0, 0, 1]\n");
  const Trajectory t = load_truth(a, 30);
  ASSERT_EQ(t.size(), 2U);
  EXPECT_EQ(t[1].t_ns, 100'000'000);
  EXPECT_THAT(t[0].cam_from_world.center(), VectorNear(Eigen::Vector3d(1, 2.5, 3), 1e-9)) << "half a metre along its x";
  a.calibration = folder_.write("plain.yaml", "fx: 1\n");
  EXPECT_THAT(load_truth(a, 30)[0].cam_from_world.center(), VectorNear(Eigen::Vector3d(1, 2, 3), 1e-9));
}

TEST_F(Truth, KittiHasAPoseForEachImage) {
  for (int i = 0; i < 2; ++i) image("06/image_0/00000" + std::to_string(i) + ".png");
  folder_.write("06/times.txt", "0.0\n1.037e-01\n");
  const std::string twelve = "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0.1 0 1 0 0 0 0 1 1.2\n",
                    sixteen = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n1 0 0 0.1 0 1 0 0 0 0 1 1.2 0 0 0 1\n",
                    numbered = "0 1 0 0 0 0 1 0 0 0 0 1 0\n1 1 0 0 0.1 0 1 0 0 0 0 1 1.2\n";
  for (const std::string& poses : {twelve, sixteen, numbered}) {
    const Trajectory t = load_truth(agent(poses, "06"), 10);
    ASSERT_EQ(t.size(), 2U);
    EXPECT_EQ(t[1].t_ns, 103'700'000);
    EXPECT_THAT(t[1].cam_from_world.center(), VectorNear(Eigen::Vector3d(0.1, 0, 1.2), 1e-9));
  }
  EXPECT_EQ(load_truth(agent("1 1 0 0 0 0 1 0 0 0 0 1 0\n", "06"), 10).at(0).t_ns, 103'700'000);
  const auto error = [&](const std::string& poses) {
    return test::error_of<UserError>([&] { load_truth(agent(poses, "06"), 10); });
  };
  EXPECT_THAT(error(twelve + "1 0 0 0 0 1 0 0 0 0 1 2\n"), HasSubstr("truth.txt: 3 poses for 2 images"));
  EXPECT_THAT(error("x 1 0 0 0 0 1 0 0 0 0 1 0\n"), HasSubstr("truth.txt:1: 'x' is no number of an image"));
  EXPECT_EQ(load_truth(agent(numbered + "2 1 0 0 0 0 1 0 0 0 0 1 0\n", "06"), 10).size(), 2U) << "of an image more";
  for (int i = 0; i < 3; ++i) image("07/image_0/00000" + std::to_string(i) + ".png");
  folder_.write("07/times.txt", "0.0\n0.0\n0.1\n");
  const Trajectory repeated =
      load_truth(agent("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 9 0 1 0 0 0 0 1 9\n1 0 0 0 0 1 0 0 0 0 1 1\n", "07"), 10);
  ASSERT_EQ(repeated.size(), 2U) << "an image is left out, and its pose";
  EXPECT_THAT(repeated[1].cam_from_world.center(), VectorNear(Eigen::Vector3d(0, 0, 1), 1e-9));
  const Trajectory at_rate = load_truth(agent("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1\n", "no.mp4"), 10);
  EXPECT_EQ(at_rate[1].t_ns, 100'000'000);
}

TEST_F(Truth, SaysWhatIsWrong) {
  const auto error = [&](const std::string& text) {
    const SequenceAgent a = agent(text, "no.mp4");
    return test::error_of<UserError>([&] { load_truth(a, 30); });
  };
  EXPECT_THAT(error("# nothing\n"), HasSubstr("truth.txt: has no pose"));
  EXPECT_THAT(error("time,lat,lon,alt\n0.0,47.1,8.1,1\n"), HasSubstr("truth.txt:2: 4 fields; poses are lines `t_s"));
  EXPECT_THAT(error("2,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n"), HasSubstr("truth.txt:2: the time is earlier"));
  EXPECT_THAT(error("1,0,0,0,2,0,0,0\n"), HasSubstr("truth.txt:1: not a unit quaternion"));
  EXPECT_THAT(
      error("Frame,Sub Frame,RX,RY,RZ,TX,TY,TZ\n,,rad,rad,rad,mm,mm,mm\n1,0,0.1,0.2,0.3,-1662.1,-721.4,1495.3\n"),
      HasSubstr("truth.txt:3: not a unit quaternion; poses in another form, as Vicon's or COLMAP's, are"));
  EXPECT_THAT(error("1 0 0 0 0 1 0 0 0 0 1 x\n"), HasSubstr("'x' is not a number"));
}

}  // namespace
}  // namespace coslam::eval::truth_test
