// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/video/video_packets.h"

#include <gmock/gmock.h>

#include "agent/capture/source.h"
#include "common/base/error.h"
#include "common/image/image_file.h"
#include "common/mcap/writer.h"
#include "common/ros/cdr.h"
#include "common/ros/convert.h"
#include "common/ros/foxglove_messages.h"
#include "common/ros/sensor_messages.h"
#include "tests/common/video/encoded_video.h"
#include "tests/support/temp_folder.h"

namespace coslam::video_packets_test {
namespace {

constexpr int kWidth = 64, kHeight = 48, kFrames = 12;
constexpr TimeNs kStart_ns = 1'700'000'000'000'000'000, kPeriod_ns = 50'000'000;

// Frame i is evenly 20 + 10 i; every fifth is a key frame.
std::vector<std::vector<std::uint8_t>> packets(const char* encoder = "libx264") {
  std::vector<cv::Mat> frames;
  for (int i = 0; i < kFrames; ++i) frames.emplace_back(kHeight, kWidth, CV_8UC1, cv::Scalar(20 + 10 * i));
  return test::encoded_video(frames, encoder);
}

struct Codec {
  const char *encoder, *name;
};
class VideoPacketsOf : public ::testing::TestWithParam<Codec> {};

TEST_P(VideoPacketsOf, FramesComeOnePacketEach) {
  const auto video = packets(GetParam().encoder);
  if (video.empty()) GTEST_SKIP() << "FFmpeg has no encoder for it";
  ASSERT_EQ(video.size(), std::size_t{kFrames});
  const auto decoder = VideoPackets::for_codec(GetParam().name);
  ASSERT_TRUE(decoder);
  for (int i = 0; i < kFrames; ++i) {
    const cv::Mat luma = mat_of(decoder->decode(video[static_cast<std::size_t>(i)]));
    ASSERT_EQ(luma.size(), cv::Size(kWidth, kHeight)) << i;
    EXPECT_EQ(luma.type(), CV_8UC1);
    EXPECT_NEAR(luma.at<std::uint8_t>(20, 20), 20 + 10 * i, 2);
  }
}

INSTANTIATE_TEST_SUITE_P(Codecs, VideoPacketsOf,
                         ::testing::Values(Codec{"libx264", "h264"}, Codec{"libx265", "h265"},
                                           Codec{"libvpx-vp9", "vp9"}, Codec{"libaom-av1", "av1"}),
                         [](const auto& codec) { return std::string(codec.param.name); });

TEST(VideoPackets, BeforeTheFirstKeyFrameThereIsNone) {
  const auto video = packets();
  if (video.empty()) GTEST_SKIP() << "FFmpeg has no encoder for it";
  const auto decoder = VideoPackets::for_codec("libx264");
  ASSERT_TRUE(decoder);
  for (std::size_t i = 2; i < video.size(); ++i) EXPECT_EQ(decoder->decode(video[i]).empty(), i < 5) << i;
  EXPECT_TRUE(decoder->decode({}).empty());
  EXPECT_TRUE(decoder->decode(std::vector<std::uint8_t>(100, 7)).empty());
}

TEST(VideoPackets, OtherFormatsAreNone) {
  EXPECT_FALSE(VideoPackets::for_codec("jpeg"));
  EXPECT_FALSE(VideoPackets::for_codec("rgb8; jpeg compressed bgr8"));
  EXPECT_FALSE(VideoPackets::for_codec(""));
  EXPECT_TRUE(VideoPackets::for_codec("hevc"));
}

TEST(VideoPackets, ATopicOfThemIsASource) {
  const auto video = packets();
  if (video.empty()) GTEST_SKIP() << "FFmpeg has no encoder for it";
  std::string octets;
  mcap::Writer writer([&](std::string_view more) { octets += more; });
  const auto foxglove =
      writer.add_channel("/foxglove", "cdr", writer.add_schema("foxglove_msgs/msg/CompressedVideo", "ros2msg", ""));
  const auto ros =
      writer.add_channel("/ros", "cdr", writer.add_schema("sensor_msgs/msg/CompressedImage", "ros2msg", ""));
  for (std::size_t i = 0; i < video.size(); ++i) {
    const TimeNs t_ns = kStart_ns + static_cast<TimeNs>(i) * kPeriod_ns;
    writer.write(foxglove, t_ns, ros::to_cdr(ros::foxglove::CompressedVideo{ros::time_of(t_ns), "", video[i], "h264"}));
    writer.write(ros, t_ns, ros::to_cdr(ros::CompressedImage{ros::header_of(t_ns, ""), "h264", video[i]}));
  }
  writer.close();
  const test::TempFolder folder;
  const std::string file = folder.write("a.mcap", octets).string();
  for (const char* topic : {"#/foxglove", "#/ros"}) {
    const auto source = open_source("bag:" + file + topic, {});
    source->skip();  // the next needs it all the same
    for (int i = 1; i < kFrames; ++i) {
      const auto image = source->next();
      ASSERT_TRUE(image) << topic << i;
      EXPECT_EQ(image->capture_ns, to_ns(0.1) + i * kPeriod_ns);
      EXPECT_NEAR(image->grey.at<std::uint8_t>(20, 20), 20 + 10 * i, 1);
    }
    EXPECT_FALSE(source->next());
    SourceOptions later;
    later.start_s = 0.1 + 0.05 * 7;
    EXPECT_NEAR(open_source("bag:" + file + topic, later)->next()->grey.at<std::uint8_t>(20, 20), 20 + 10 * 7, 1);
  }
}

}  // namespace
}  // namespace coslam::video_packets_test
