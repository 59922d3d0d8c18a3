// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "agent/capture/source.h"
#include "common/base/error.h"
#include "common/dataset/calibration.h"
#include "common/mcap/writer.h"
#include "common/ros/cdr.h"
#include "common/ros/convert.h"
#include "common/ros/sensor_messages.h"
#include "common/ros/type.h"
#include "tests/support/temp_folder.h"

namespace coslam {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 64, kHeight = 48;
constexpr TimeNs kStart_ns = 1'700'000'000'000'000'000, kPeriod_ns = 50'000'000, kDelay_ns = 2'000'000,
                 kBefore_ns = 100'000'000;
const SourceOptions kOptions{0, {}, 10, kWidth, kHeight, "calib.yaml"};

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
  const auto source = open_source(named("/left/image_raw"), kOptions);
  EXPECT_EQ(source->peek_ns(), kBefore_ns);
  for (int i = 0; i < 10; ++i) {
    const auto got = source->next();
    ASSERT_TRUE(got) << i;
    EXPECT_EQ(got->frame, FrameId(static_cast<std::uint32_t>(i)));
    EXPECT_EQ(got->capture_ns, kBefore_ns + i * kPeriod_ns) << "since a little before the recording began";
    EXPECT_EQ(got->grey.at<std::uint8_t>(kHeight - 1, kWidth - 1), 20 * i);
  }
  EXPECT_FALSE(source->next());
  EXPECT_EQ(source->unreadable(), 0U);
}

TEST_F(Recorded, TimesThatAreNoneOverflowNothing) {
  ros::Image late = image(0, "mono8", 1);
  late.header = ros::header_of(-2'000'000'000'000'000'000, "left");
  put("/left/image_raw", std::numeric_limits<TimeNs>::max(), late);
  const auto source = open_source(named("/left/image_raw"), kOptions);
  EXPECT_EQ(source->peek_ns(), 0) << "of a clock of its own";
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
  EXPECT_EQ(source->next()->grey.at<std::uint8_t>(0, 0), 12);
  EXPECT_EQ(source->unreadable(), 1U);
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
  const std::string left = named("/left"), file = left.substr(0, left.find('#'));
  const auto error = [&](const std::string& uri, const SourceOptions& options = kOptions) {
    return test::error_of<UserError>([&] { open_source(uri, options); });
  };
  EXPECT_THAT(error(file), HasSubstr("no topic is named"));
  EXPECT_THAT(error(file + "#/middle"), HasSubstr("of these there are: /left, /right, /deep"));
  EXPECT_THAT(error(file + "#/deep"), HasSubstr("its encoding is 32FC1"));
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
  info.k = {500, 0, 320.5, 0, 501, 240.25, 0, 0, 1};
  put("/left/camera_info", kStart_ns, info);
  const CameraModel camera = load_calibration(named("/left/camera_info"));
  EXPECT_EQ(camera.width_px, 640);
  EXPECT_EQ(camera.fy, 501);
  EXPECT_EQ(camera.cx, 320.5);
  EXPECT_EQ(camera.distortion, DistortionModel::kRadTan);
  EXPECT_EQ(camera.coefficients[4], 0.05);
}

}  // namespace
}  // namespace coslam
