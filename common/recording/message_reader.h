// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "common/base/time.h"
#include "common/recording/recording.h"
#include "common/ros/sensor_messages.h"

namespace coslam::recording {

enum class MessageKind : std::uint8_t { kImage, kCompressedImage, kCameraInfo };

// Reads the messages of one topic, whatever they are written in (CDR, ROS 1, protobuf, JSON) and by whose definition
// (sensor_msgs, Foxglove), as messages of sensor_msgs. What is not as it should be comes back empty.
class MessageReader {
 public:
  // Creates a reader; empty: the topic's messages are of no kind or in no form that is read.
  static std::optional<MessageReader> for_topic(const Topic& topic);

  MessageKind kind() const { return kind_; }
  // A message without the compression by which rosbag2 packs each on its own; empty where that is damaged.
  std::string unpacked(std::string octets) const;
  // Time when the camera took the image, of its own clock. The message has to be unpacked, as for all functions below.
  std::optional<TimeNs> stamp_ns(const std::string& octets) const;
  std::optional<ros::Image> image(const std::string& octets) const;
  // A frame of a video is one too; `format` then names its codec: "h264", "h265", "hevc", "vp9", "av1".
  std::optional<ros::CompressedImage> compressed_image(const std::string& octets) const;
  std::optional<ros::CameraInfo> camera_info(const std::string& octets) const;

 private:
  enum class Form : std::uint8_t { kCdr, kRos1, kProtobuf, kJson };
  enum class Definition : std::uint8_t {
    kImage,
    kCompressedImage,
    kFfmpegPacket,
    kCameraInfo,
    kFoxgloveRawImage,
    kFoxgloveCompressedImage,
    kFoxgloveCompressedVideo,
    kFoxgloveCameraCalibration
  };

  MessageReader(Form form, Definition definition);
  static std::optional<Form> form_of(const std::string& encoding);
  bool is_foxglove() const { return definition_ >= Definition::kFoxgloveRawImage; }
  template <class T>
  std::optional<T> read_ros(const std::string& octets) const;
  template <class T>
  std::optional<T> read_foxglove(const std::string& octets) const;

  Form form_;
  Definition definition_;
  MessageKind kind_;
};

}  // namespace coslam::recording
