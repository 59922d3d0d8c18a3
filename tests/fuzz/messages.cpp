// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Messages of recordings in every form: the first octet says which, the rest is the message.
#include <array>
#include <string>

#include "common/compression/compression.h"
#include "common/recording/message_reader.h"
#include "common/ros/convert.h"
#include "common/ros/foxglove_messages.h"
#include "tests/common/recording/ros1_octets.h"
#include "tests/fuzz/fuzzer.h"

namespace coslam {
namespace {

struct Form {
  const char *type, *encoding;
};
constexpr std::array kForms = std::to_array<Form>({{"sensor_msgs/msg/Image", "cdr"},
                                                   {"sensor_msgs/msg/CompressedImage", "cdr"},
                                                   {"sensor_msgs/msg/CameraInfo", "cdr"},
                                                   {"ffmpeg_image_transport_msgs/msg/FFMPEGPacket", "cdr"},
                                                   {"sensor_msgs/Image", "ros1"},
                                                   {"sensor_msgs/CompressedImage", "ros1"},
                                                   {"sensor_msgs/CameraInfo", "ros1"},
                                                   {"foxglove_msgs/msg/RawImage", "cdr"},
                                                   {"foxglove_msgs/CompressedVideo", "ros1"},
                                                   {"foxglove.RawImage", "protobuf"},
                                                   {"foxglove.CompressedImage", "protobuf"},
                                                   {"foxglove.CompressedVideo", "protobuf"},
                                                   {"foxglove.CameraCalibration", "protobuf"},
                                                   {"foxglove.RawImage", "json"},
                                                   {"foxglove.CompressedImage", "json"},
                                                   {"foxglove.CameraCalibration", "json"}});

std::string seed(std::size_t form, const std::string& message) {
  return std::string(1, static_cast<char>(form)) + message;
}

}  // namespace

void fuzz::try_octets(Octets octets) {
  if (octets.empty()) return;
  const Form& form = kForms[octets[0] % kForms.size()];
  const auto reader = recording::MessageReader::for_topic({"/topic", form.type, form.encoding});
  const std::string message = reader->unpacked(std::string(text_of(octets).substr(1)));
  reader->stamp_ns(message);
  reader->image(message);
  reader->compressed_image(message);
  reader->camera_info(message);
}

void fuzz::write_seeds(const WriteSeed& write) {
  ros::Image image;
  image.header = ros::header_of(to_ns(1), "left");
  image.encoding = "mono8";
  image.data.assign(4, 100);
  write("image", seed(0, recording::test::to_cdr_text(image)));
  write("image_packed", seed(0, zstd_compressed(recording::test::to_cdr_text(image))));
  write("image_ros1", seed(4, recording::test::to_ros1(image)));
  ros::CameraInfo info;
  info.d = {0.1, 0.2};
  write("info", seed(2, recording::test::to_cdr_text(info)));
  write("info_ros1", seed(6, recording::test::to_ros1(info)));
  write("raw", seed(7, recording::test::to_cdr_text(ros::foxglove::RawImage())));
  using namespace std::string_literals;
  const std::string doubles = "\x2a\x10"s + std::string(16, '\x3f');
  write("protobuf_raw", seed(9, "\x0a\x04\x08\x05\x10\x07\x15\x03\0\0\0\x1d\x02\0\0\0\x22\x05mono8\x32\x02\x01\x02"s));
  write("protobuf_lens", seed(12, "\x15\x03\0\0\0\x22\x05plumb"s + doubles));
  const std::string stamp = R"({"timestamp": {"sec": 1, "nsec": 2}, "frame_id": "left", )";
  write("json_raw",
        seed(13, stamp + R"("width": 3, "height": 2, "encoding": "mono8", "step": 4, "data": "AQIDAAQFBgA="})"));
  write("json_lens", seed(15, stamp + R"("width": 3, "D": [0.5], "K": [500, 0, 320, 0, 501, 240, 0, 0, 1]})"));
}

}  // namespace coslam
