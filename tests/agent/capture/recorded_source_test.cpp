// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "agent/capture/source.h"
#include "common/base/error.h"
#include "common/base/log.h"
#include "common/compression/compression.h"
#include "common/dataset/calibration.h"
#include "common/mcap/writer.h"
#include "common/ros/cdr.h"
#include "common/ros/convert.h"
#include "common/ros/sensor_messages.h"
#include "common/ros/type.h"
#include "tests/common/mcap/mcap_file.h"
#include "tests/common/recording/bag_file.h"
#include "tests/common/recording/db3_file.h"
#include "tests/common/recording/ros1_octets.h"
#include "tests/support/temp_folder.h"

namespace coslam::recorded_source_test {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 64, kHeight = 48;
constexpr TimeNs kStart_ns = 1'700'000'000'000'000'000, kPeriod_ns = 50'000'000, kDelay_ns = 2'000'000,
                 kBefore_ns = 100'000'000;
const SourceOptions kOptions{0, {}, 10, kWidth, kHeight, "calib.yaml"};

using recording::test::to_cdr_text;
using recording::test::to_ros1;

// A recording of ROS 2: ten images, each noted a little after it was taken.
class Recorded : public ::testing::Test {
 protected:
  template <class Message>
  void put(const std::string& topic, TimeNs noted_ns, const Message& message) {
    const ros::TypeText& type = ros::type_text<Message>();
    const auto channel = writer_.add_channel(topic, "cdr", writer_.add_schema(type.name, "ros2msg", type.schema));
    writer_.write(channel, noted_ns, ros::to_cdr(message));
  }

  static ros::Image image(int i, const std::string& encoding, int channels) {
    ros::Image m;
    m.header = ros::header_of(kStart_ns + i * kPeriod_ns, "left");
    m.width = kWidth;
    m.height = kHeight;
    m.encoding = encoding;
    m.step = static_cast<std::uint32_t>(kWidth * channels + 8);  // rows may be longer than their pixels
    m.data.assign(std::size_t{m.step} * kHeight, static_cast<std::uint8_t>(20 * i));
    return m;
  }

  void write_images(const std::string& topic, const std::string& encoding, int channels) {
    for (int i = 0; i < 10; ++i) put(topic, kStart_ns + i * kPeriod_ns + kDelay_ns, image(i, encoding, channels));
  }

  std::string named(const std::string& topic) {
    writer_.close();
    return "mcap:" + folder_.write("a.mcap", octets_).string() + (topic.empty() ? "" : "#" + topic);
  }

  test::TempFolder folder_;
  std::string octets_;
  mcap::Writer writer_{[this](std::string_view more) { octets_ += more; }, {.chunk_bytes = 20'000}};
};

TEST_F(Recorded, ImagesComeWithTheirStamps) {
  put("/clock", kStart_ns, ros::Header{});  // the recording begins before its images
  write_images("/left/image_raw", "mono8", 1);
  const std::string name = named("/left/image_raw");
  EXPECT_EQ(written_zero_ns(name, 30), kStart_ns - kBefore_ns) << "as its stamps have it";
  const auto source = open_source(name, kOptions);
  EXPECT_EQ(source->peek_ns(), kBefore_ns);
  for (int i = 0; i < 10; ++i) {
    const auto got = source->next();
    ASSERT_TRUE(got) << i;
    EXPECT_EQ(got->frame, FrameId(static_cast<std::uint32_t>(i)));
    EXPECT_EQ(got->capture_ns, kBefore_ns + i * kPeriod_ns) << "since a little before the recording began";
    EXPECT_EQ(got->grey.at<std::uint8_t>(kHeight - 1, kWidth - 1), 20 * i);
  }
  EXPECT_FALSE(source->next());
  EXPECT_EQ(source->undated(), 0U);
}

TEST_F(Recorded, TimesThatAreNoneOverflowNothing) {
  ros::Image late = image(0, "mono8", 1);
  late.header = ros::header_of(-2'000'000'000'000'000'000, "left");
  put("/left/image_raw", std::numeric_limits<TimeNs>::max(), late);
  const auto source = open_source(named("/left/image_raw"), kOptions);
  EXPECT_EQ(source->peek_ns(), 0) << "of a clock of its own";
}

TEST_F(Recorded, ImagesThatWereWrittenInAnotherOrderComeByTheirStamps) {
  for (int i = 0; i < 40; ++i) put("/left", kStart_ns + i * kPeriod_ns, image(i ^ 1, "mono8", 1));
  const auto source = open_source(named("/left"), kOptions);
  for (int i = 0; i < 40; ++i) {
    const auto got = source->next();
    ASSERT_TRUE(got) << i;
    EXPECT_EQ(got->capture_ns, kBefore_ns + i * kPeriod_ns);
  }
  EXPECT_FALSE(source->next());
  EXPECT_EQ(source->undated(), 0U);
}

TEST_F(Recorded, ImagesWithoutAStampAreLeftOutAndCounted) {
  for (int i = 0; i < 40; ++i) {
    ros::Image m = image(i, "mono8", 1);
    if (i % 10 == 0) m.header = ros::header_of(0, "left");
    put("/left", kStart_ns + i * kPeriod_ns, m);
  }
  const auto source = open_source(named("/left"), kOptions);
  EXPECT_EQ(source->peek_ns(), kBefore_ns + kPeriod_ns);
  init_log("coslam");
  testing::internal::CaptureStderr();
  int images = 0;
  while (source->next()) ++images;
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("#/left: of its images 4 had no stamp, or one "));
  EXPECT_EQ(images, 36);
  EXPECT_EQ(source->undated(), 4U);
}

TEST_F(Recorded, StampsThatAreNoneGiveWayToTheTimesOfReceipt) {
  for (int i = 0; i < 40; ++i) {
    ros::Image m = image(i, "mono8", 1);
    m.header = ros::header_of(kStart_ns + i * kPeriod_ns / 1000, "left");
    put("/left", kStart_ns + i * kPeriod_ns, m);
  }
  const auto source = open_source(named("/left"), kOptions);
  source->skip();
  EXPECT_EQ(source->peek_ns(), kBefore_ns + kPeriod_ns);
}

TEST_F(Recorded, ColoursBecomeGrey) {
  write_images("/left/image_raw", "rgb8", 3);
  const auto source = open_source(named("/left/image_raw"), kOptions);
  source->skip();
  EXPECT_EQ(source->next()->grey.at<std::uint8_t>(3, 3), 40 - 20);
}

TEST_F(Recorded, CompressedImagesToo) {
  for (int i = 0; i < 3; ++i) {
    ros::CompressedImage m{ros::header_of(kStart_ns + i * kPeriod_ns, "left"), "png", {}};
    cv::imencode(".png", cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(10 + i)), m.data);
    if (i == 1) m.data.resize(m.data.size() / 2);
    put("/left/image_raw/compressed", kStart_ns + i * kPeriod_ns, m);
  }
  const auto source = open_source(named(""), kOptions);  // the only one
  EXPECT_EQ(source->next()->grey.at<std::uint8_t>(0, 0), 10);
  EXPECT_EQ(source->next()->fault, ImageFault::kUnreadable);
  EXPECT_EQ(source->next()->grey.at<std::uint8_t>(0, 0), 12);
}

TEST_F(Recorded, AnotherClockOfTheStampsCountsFromItsFirst) {
  for (int i = 0; i < 3; ++i) put("/left", kStart_ns + 1'000'000'000'000 + i * kPeriod_ns, image(i, "mono8", 1));
  const auto source = open_source(named("/left"), kOptions);
  EXPECT_EQ(source->peek_ns(), 0);
}

TEST_F(Recorded, OnlyThePartThatIsAskedForIsPlayed) {
  write_images("/left", "mono8", 1);
  SourceOptions options = kOptions;
  options.start_s = 0.2;
  options.duration_s = 0.1;
  const auto source = open_source(named("/left"), options);
  int images = 0;
  while (const auto got = source->next()) {
    EXPECT_GE(got->capture_ns, 0);
    EXPECT_LT(got->capture_ns, to_ns(0.1));
    ++images;
  }
  EXPECT_EQ(images, 2);
}

TEST_F(Recorded, SaysWhatIsWrong) {
  write_images("/left", "mono8", 1);
  write_images("/right", "mono8", 1);
  write_images("/deep", "32FC1", 2);
  ros::Image cut_off = image(0, "mono8", 1);
  cut_off.data.resize(10);
  put("/short", kStart_ns, cut_off);
  const std::string left = named("/left"), file = left.substr(0, left.find('#'));
  const auto error = [&](const std::string& uri, const SourceOptions& options = kOptions) {
    return test::error_of<UserError>([&] { open_source(uri, options); });
  };
  EXPECT_THAT(error(file), HasSubstr("no topic is named"));
  EXPECT_THAT(error(file + "#/middle"), HasSubstr("of these there are: /left, /right, /deep, /short"));
  EXPECT_THAT(error(file + "#/deep"), HasSubstr("its encoding is 32FC1"));
  EXPECT_THAT(error(file + "#/short"), HasSubstr("can be read; it has 10 octets, and 48 rows of 72 are needed"));
  EXPECT_THAT(error("mcap:/nowhere.mcap#/left"), HasSubstr("/nowhere.mcap: cannot be read"));
  SourceOptions other = kOptions;
  other.width_px = 640;
  EXPECT_THAT(error(left, other), HasSubstr("is 64x48 pixels, but the calibration calib.yaml is for 640x48"));
}

TEST_F(Recorded, ImagesInAnotherFormAreNamed) {
  const auto foxglove = writer_.add_channel("/front", "flatbuffer",
                                            writer_.add_schema("foxglove.CompressedImage", "flatbuffer", "definition"));
  writer_.write(foxglove, kStart_ns, "octets");
  const auto words = writer_.add_channel("/words", "cdr", writer_.add_schema("std_msgs/msg/String", "ros2msg", ""));
  writer_.write(words, kStart_ns, "octets");
  const std::string uri = named("/front"), file = uri.substr(0, uri.find('#'));
  const std::string form = "not in a form that is read: /front (foxglove.CompressedImage in flatbuffer)";
  EXPECT_THAT(test::error_of<UserError>([&] { open_source(uri, kOptions); }), HasSubstr(form));
  EXPECT_THAT(test::error_of<UserError>([&] { open_source(file, kOptions); }), testing::EndsWith(form));
  EXPECT_THAT(test::error_of<UserError>([&] { open_source(file + "#/words", kOptions); }),
              HasSubstr("/words (std_msgs/msg/String in cdr)"));
}

TEST_F(Recorded, CameraInfoIsACalibration) {
  ros::CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.distortion_model = "plumb_bob";
  info.d = {0.1, -0.2, 0.001, 0.002, 0.05};
  put("/left/camera_info", kStart_ns, info);  // of a driver that has not been told yet
  info.k = {500, 0, 320.5, 0, 501, 240.25, 0, 0, 1};
  put("/left/camera_info", kStart_ns + kPeriod_ns, info);
  const CameraModel camera = load_calibration(named("/left/camera_info"));
  EXPECT_EQ(camera.width_px, 640);
  EXPECT_EQ(camera.fy, 501);
  EXPECT_EQ(camera.cx, 320.5);
  EXPECT_EQ(camera.distortion, DistortionModel::kRadTan);
  EXPECT_EQ(camera.coefficients[4], 0.05);
}

// The same images and lens, in every container and form.
class RecordedIn : public Recorded {
 protected:
  static ros::CameraInfo lens() {
    ros::CameraInfo info;
    info.width = kWidth;
    info.height = kHeight;
    info.distortion_model = "plumb_bob";
    info.d = {0.1, -0.2, 0.001, 0.002, 0.05};
    info.k = {50, 0, 32.5, 0, 51, 24.25, 0, 0, 1};
    return info;
  }
  static TimeNs noted_ns(int i) { return kStart_ns + i * kPeriod_ns + kDelay_ns; }

  std::string bag(const std::string& compression) {
    recording::test::BagFile file(compression, 3);
    file.add("/left/camera_info", "sensor_msgs/CameraInfo", noted_ns(0), to_ros1(lens()));
    for (int i = 0; i < 10; ++i) {
      file.add("/left/image_raw", "sensor_msgs/Image", noted_ns(i), to_ros1(image(i, "mono8", 1)));
    }
    return folder_.write("a.bag", file.closed()).string();
  }
  // compressed: each message with zstd.
  std::string db3(bool compressed = false) {
    const auto packed = [&](const std::string& octets) { return compressed ? zstd_compressed(octets) : octets; };
    recording::test::Db3File file(folder_ / "a.db3");
    const auto info = file.add_topic("/left/camera_info", "sensor_msgs/msg/CameraInfo");
    const auto images = file.add_topic("/left/image_raw", "sensor_msgs/msg/Image");
    file.add(info, noted_ns(0), packed(to_cdr_text(lens())));
    for (int i = 0; i < 10; ++i) file.add(images, noted_ns(i), packed(to_cdr_text(image(i, "mono8", 1))));
    return (folder_ / "a.db3").string();
  }
  std::string mcap_of_ros1() {
    const auto add = [&](const std::string& topic, const std::string& type) {
      return writer_.add_channel(topic, "ros1", writer_.add_schema(type, "ros1msg", ""));
    };
    const auto info = add("/left/camera_info", "sensor_msgs/CameraInfo");
    const auto images = add("/left/image_raw", "sensor_msgs/Image");
    writer_.write(info, noted_ns(0), to_ros1(lens()));
    for (int i = 0; i < 10; ++i) writer_.write(images, noted_ns(i), to_ros1(image(i, "mono8", 1)));
    writer_.close();
    return folder_.write("a.mcap", octets_).string();
  }

  static void expect_all(const std::string& uri) {
    const auto source = open_source(uri, kOptions);
    for (int i = 0; i < 10; ++i) {
      const auto got = source->next();
      ASSERT_TRUE(got) << uri << " " << i;
      EXPECT_EQ(got->capture_ns, kBefore_ns - kDelay_ns + i * kPeriod_ns);
      EXPECT_EQ(got->grey.at<std::uint8_t>(kHeight - 1, kWidth - 1), 20 * i);
    }
    EXPECT_FALSE(source->next());
    EXPECT_EQ(source->undated(), 0U);
  }
  static void expect_read(const std::string& path) {
    expect_all("bag:" + path + "#/left/image_raw");
    expect_all("mcap:" + path + "#/left/image_raw");
    expect_all("bag:" + path);
    expect_all(path);
    for (const std::string& name :
         {"bag:" + path, path + "#/left/camera_info", "mcap:" + path + "#/left/camera_info"}) {
      const CameraModel camera = load_calibration(name);
      EXPECT_EQ(camera.fy, 51);
      EXPECT_EQ(camera.coefficients[4], 0.05);
    }
  }
};

TEST_F(RecordedIn, BagsOfRos1) {
  for (const char* compression : {"none", "bz2", "lz4"}) expect_read(bag(compression));
}

TEST_F(RecordedIn, TheSqliteOfRosbag2) {
  expect_read(db3());
  const std::string packed = zstd_compressed(mcap::test::octets_in(folder_ / "a.db3"));
  expect_read(folder_.write("b.db3.zstd", packed).string());
}

TEST_F(RecordedIn, MessagesCompressedEach) { expect_read(db3(true)); }

TEST_F(RecordedIn, McapOfRos1) { expect_read(mcap_of_ros1()); }

TEST_F(RecordedIn, AFolderOfRosbag2) {
  const std::string file = db3();
  std::filesystem::create_directory(folder_ / "walk");
  std::filesystem::rename(file, folder_ / "walk" / "walk_0.db3");
  folder_.write("walk/metadata.yaml",
                "rosbag2_bagfile_information:\n  version: 4\n  relative_file_paths: [walk_0.db3]\n");
  expect_read((folder_ / "walk").string());
}

TEST_F(RecordedIn, APathWithSeveralTopicsNamesThem) {
  write_images("/left", "mono8", 1);
  write_images("/right", "mono8", 1);
  const std::string file = named("").substr(std::string("mcap:").size());
  EXPECT_THAT(test::error_of<UserError>([&] { open_source(file, kOptions); }),
              HasSubstr("no topic is named (bag:PATH#TOPIC) of images; of these there are: /left, /right"));
  EXPECT_FALSE(listed_times(file, 30));
  EXPECT_EQ(first_file(file, 30), "");
}

TEST_F(RecordedIn, TopicsInOtherFormsAreListedWithWhatConvertsThem) {
  const auto theora = writer_.add_channel("/left/theora", "cdr",
                                          writer_.add_schema("theora_image_transport/msg/Packet", "ros2msg", ""));
  writer_.write(theora, kStart_ns, "octets");
  EXPECT_THAT(test::error_of<UserError>([&] { open_source(named(""), kOptions); }),
              HasSubstr("/left/theora (theora_image_transport/msg/Packet in cdr): image_transport's node republish"));
}

}  // namespace
}  // namespace coslam::recorded_source_test
