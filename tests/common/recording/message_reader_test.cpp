// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recording/message_reader.h"

#include <gmock/gmock.h>

#include "common/compression/compression.h"
#include "common/recording/json.h"
#include "common/ros/cdr.h"
#include "common/ros/foxglove_messages.h"

namespace coslam::recording::message_reader_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr TimeNs kStamp_ns = 1'700'000'000'123'456'789;

std::string from_hex(std::string_view hex) {
  std::string octets;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
    octets.push_back(static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16)));
  }
  return octets;
}

MessageReader reader_of(const std::string& type, const std::string& encoding) {
  return MessageReader::for_topic({"/topic", type, encoding}).value();
}

void expect_image(const MessageReader& reader, const std::string& octets) {
  EXPECT_EQ(reader.kind(), MessageKind::kImage);
  EXPECT_EQ(reader.stamp_ns(octets), kStamp_ns);
  const auto image = reader.image(octets);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->header.frame_id, "left");
  EXPECT_EQ(image->width, 3U);
  EXPECT_EQ(image->height, 2U);
  EXPECT_EQ(image->encoding, "mono8");
  EXPECT_EQ(image->is_bigendian, 0);
  EXPECT_EQ(image->step, 4U);
  EXPECT_THAT(image->data, ElementsAre(1, 2, 3, 0, 4, 5, 6, 0));
  EXPECT_FALSE(reader.compressed_image(octets));
  EXPECT_FALSE(reader.camera_info(octets));
  EXPECT_FALSE(reader.image(octets.substr(0, octets.size() - 9))) << "cut off";
}

void expect_compressed(const MessageReader& reader, const std::string& octets, const std::string& format = "jpeg") {
  EXPECT_EQ(reader.kind(), MessageKind::kCompressedImage);
  EXPECT_EQ(reader.stamp_ns(octets), kStamp_ns);
  const auto image = reader.compressed_image(octets);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->header.frame_id, "left");
  EXPECT_EQ(image->format, format);
  EXPECT_THAT(image->data, ElementsAre(0xff, 0xd8, 0xff));
  EXPECT_FALSE(reader.image(octets));
  EXPECT_FALSE(reader.compressed_image(octets.substr(0, octets.size() / 2)));
}

void expect_lens(const MessageReader& reader, const std::string& octets) {
  EXPECT_EQ(reader.kind(), MessageKind::kCameraInfo);
  EXPECT_EQ(reader.stamp_ns(octets), 2'000'000'000);
  const auto info = reader.camera_info(octets);
  ASSERT_TRUE(info);
  EXPECT_EQ(info->header.frame_id, "left");
  EXPECT_EQ(info->width, 640U);
  EXPECT_EQ(info->height, 480U);
  EXPECT_EQ(info->distortion_model, "plumb_bob");
  EXPECT_THAT(info->d, ElementsAre(0.5, -0.25));
  EXPECT_THAT(info->k, ElementsAre(500, 0, 320, 0, 501, 240, 0, 0, 1));
}

TEST(MessageReader, WhatRos1Writes) {  // by genpy 0.6
  expect_image(
      reader_of("sensor_msgs/Image", "ros1"),
      from_hex("0900000000f1536515cd5b07040000006c6566740200000003000000050000006d6f6e6f380004000000080000000102"
               "030004050600"));
  expect_compressed(reader_of("sensor_msgs/CompressedImage", "ros1"),
                    from_hex("0900000000f1536515cd5b07040000006c656674040000006a70656703000000ffd8ff"));
  const std::string info = from_hex(
      "000000000200000000000000040000006c656674e00100008002000009000000706c756d625f626f6202000000000000000000e03f000000"
      "0000"
      "00d0bf0000000000407f400000000000000000000000000000744000000000000000000000000000507f400000000000006e400000000000"
      "0000"
      "000000000000000000000000000000f03f000000000000f03f000000000000000000000000000000000000000000000000000000000000f0"
      "3f00"
      "0000000000000000000000000000000000000000000000000000000000f03f0000000000407f400000000000000000000000000000744000"
      "0000"
      "000000000000000000000000000000000000507f400000000000006e40000000000000000000000000000000000000000000000000000000"
      "00"
      "0000f03f000000000000000001000000020000000300000000000000000000000000000001");
  const MessageReader reader = reader_of("sensor_msgs/CameraInfo", "ros1");
  expect_lens(reader, info);
  const auto read = reader.camera_info(info);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->p[6], 240);
  EXPECT_EQ(read->binning_y, 2U);
  EXPECT_EQ(read->roi.x_offset, 3U);
  EXPECT_TRUE(read->roi.do_rectify);
}

TEST(MessageReader, FoxgloveInProtobuf) {  // by protobuf 3.21 from Foxglove's definitions
  expect_image(
      reader_of("foxglove.RawImage", "protobuf"),
      from_hex("0a0b0880e2cfaa0610959aef3a15030000001d0200000022056d6f6e6f382d04000000320801020300040506003a046c65"
               "6674"));
  expect_compressed(reader_of("foxglove.CompressedImage", "protobuf"),
                    from_hex("0a0b0880e2cfaa0610959aef3a1203ffd8ff1a046a70656722046c656674a2060178"));
  expect_lens(
      reader_of("foxglove.CameraCalibration", "protobuf"),
      from_hex(
          "0a02080215800200001de00100002209706c756d625f626f622a10000000000000e03f000000000000d0bf32480000000000407f40"
          "0000000000000000000000000000744000000000000000000000000000507f400000000000006e40000000000000000000000000"
          "00000000000000000000f03f4a046c656674"));
}

TEST(MessageReader, FoxgloveInJson) {
  const std::string stamp = R"({"timestamp": {"sec": 1700000000, "nsec": 123456789}, "frame_id": "left", )";
  expect_image(reader_of("foxglove.RawImage", "json"),
               stamp + R"("width": 3, "height": 2, "encoding": "mono8", "step": 4, "data": "AQIDAAQFBgA="})");
  expect_compressed(reader_of("foxglove.CompressedImage", "json"), stamp + R"("format": "jpeg", "data": "/9j/"})");
  expect_compressed(reader_of("foxglove.CompressedVideo", "json"), stamp + R"("format": "h264", "data": "/9j/"})",
                    "h264");
  expect_lens(
      reader_of("foxglove.CameraCalibration", "json"),
      R"({"timestamp": {"sec": 2, "nsec": 0}, "frame_id": "left", "width": 640, "height": 480, "D": [0.5, -0.25],)"
      R"("distortion_model": "plumb_bob", "K": [500, 0, 320, 0, 501, 240, 0, 0, 1], "R": [], "more": {"a": [1]}})");
}

TEST(MessageReader, FoxgloveInCdr) {
  ros::foxglove::RawImage raw;
  raw.timestamp = {1'700'000'000, 123'456'789};
  raw.frame_id = "left";
  raw.width = 3;
  raw.height = 2;
  raw.encoding = "mono8";
  raw.step = 4;
  raw.data = {1, 2, 3, 0, 4, 5, 6, 0};
  const auto octets = ros::to_cdr(raw);
  expect_image(reader_of("foxglove_msgs/msg/RawImage", "cdr"), std::string(octets.begin(), octets.end()));
}

TEST(MessageReader, APacketOfAVideoNamesItsCodec) {
  ros::FfmpegPacket packet;
  packet.header = {{1'700'000'000, 123'456'789}, "left"};
  packet.encoding = "hevc;yuv420p;bgr8;bgr8";
  packet.pts = 7;
  packet.data = {0xff, 0xd8, 0xff};
  const auto octets = ros::to_cdr(packet);
  expect_compressed(reader_of("ffmpeg_image_transport_msgs/msg/FFMPEGPacket", "cdr"),
                    std::string(octets.begin(), octets.end()), "hevc");
}

TEST(MessageReader, MessagesThatRosbag2CompressedEach) {
  ros::CompressedImage image{{{1'700'000'000, 123'456'789}, "left"}, "jpeg", {0xff, 0xd8, 0xff}};
  const auto cdr = ros::to_cdr(image);
  const std::string octets(cdr.begin(), cdr.end()), packed = zstd_compressed(octets);
  const MessageReader reader = reader_of("sensor_msgs/msg/CompressedImage", "cdr");
  EXPECT_EQ(reader.unpacked(packed), octets);
  EXPECT_EQ(reader.unpacked(octets), octets);
  EXPECT_EQ(reader.unpacked(packed.substr(0, packed.size() - 1)), "");
  expect_compressed(reader, reader.unpacked(packed));
}

TEST(MessageReader, OtherTypesAndFormsAreNotRead) {
  const auto is_read = [](const std::string& type, const std::string& encoding) {
    return MessageReader::for_topic({"/topic", type, encoding}).has_value();
  };
  EXPECT_TRUE(is_read("sensor_msgs/msg/Image", "cdr"));
  EXPECT_FALSE(is_read("sensor_msgs/msg/Image", "ros1"));
  EXPECT_FALSE(is_read("sensor_msgs/Image", "cdr"));
  EXPECT_FALSE(is_read("sensor_msgs/Image", "json"));
  EXPECT_FALSE(is_read("std_msgs/String", "ros1"));
  EXPECT_FALSE(is_read("foxglove.RawImage", "flatbuffer"));
  EXPECT_FALSE(is_read("ffmpeg_image_transport_msgs/FFMPEGPacket", "ros1"));
  EXPECT_FALSE(is_read("", ""));
}

TEST(MessageReader, WhatIsDamagedIsEmpty) {
  const MessageReader protobuf = reader_of("foxglove.RawImage", "protobuf"),
                      json = reader_of("foxglove.RawImage", "json");
  EXPECT_FALSE(protobuf.image("\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff"));
  EXPECT_FALSE(protobuf.image(from_hex("0b0c"))) << "groups are no longer written";
  EXPECT_FALSE(protobuf.stamp_ns(from_hex("0a0288")));
  EXPECT_EQ(protobuf.stamp_ns(""), 0) << "a time of zero is left out";
  EXPECT_FALSE(json.image("no json"));
  EXPECT_FALSE(json.image("[1]"));
  EXPECT_FALSE(json.image(R"({"width": "3"})"));
  EXPECT_FALSE(json.image(R"({"data": "AQI-"})"));
  EXPECT_FALSE(json.stamp_ns(R"({"timestamp": 5})"));
  EXPECT_FALSE(json.image("{\"a\": " + std::string(100'000, '[') + std::string(100'000, ']') + "}"));
}

TEST(Base64, OfEveryLength) {
  EXPECT_THAT(from_base64("").value(), IsEmpty());
  EXPECT_THAT(from_base64("TQ==").value(), ElementsAre('M'));
  EXPECT_THAT(from_base64("TWE=").value(), ElementsAre('M', 'a'));
  EXPECT_THAT(from_base64("TWFu").value(), ElementsAre('M', 'a', 'n'));
  EXPECT_THAT(from_base64("+/+/").value(), ElementsAre(0xfb, 0xff, 0xbf));
  EXPECT_FALSE(from_base64("TW u"));
}

}  // namespace
}  // namespace coslam::recording::message_reader_test
