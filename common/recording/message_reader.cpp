// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recording/message_reader.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <utility>

#include "common/compression/compression.h"
#include "common/recording/json.h"
#include "common/recording/protobuf.h"
#include "common/ros/cdr.h"
#include "common/ros/convert.h"
#include "common/ros/foxglove_messages.h"
#include "common/ros/ros1.h"

namespace coslam::recording {
namespace {

constexpr std::uint64_t kMostMessageOctets = 1ULL << 30U;

std::span<const std::uint8_t> octets_in(const std::string& message) {
  return {reinterpret_cast<const std::uint8_t*>(message.data()), message.size()};
}

ros::CompressedImage as_ros(auto&& image) {
  return {{image.timestamp, std::move(image.frame_id)}, std::move(image.format), std::move(image.data)};
}

}  // namespace

MessageReader::MessageReader(Form form, Definition definition) : form_(form), definition_(definition) {
  switch (definition) {
    case Definition::kImage:
    case Definition::kFoxgloveRawImage:
      kind_ = MessageKind::kImage;
      break;
    case Definition::kCompressedImage:
    case Definition::kFfmpegPacket:
    case Definition::kFoxgloveCompressedImage:
    case Definition::kFoxgloveCompressedVideo:
      kind_ = MessageKind::kCompressedImage;
      break;
    case Definition::kCameraInfo:
    case Definition::kFoxgloveCameraCalibration:
      kind_ = MessageKind::kCameraInfo;
      break;
  }
}

std::optional<MessageReader::Form> MessageReader::form_of(const std::string& encoding) {
  constexpr std::array<std::pair<std::string_view, Form>, 4> kForms{
      {{"cdr", Form::kCdr}, {"ros1", Form::kRos1}, {"protobuf", Form::kProtobuf}, {"json", Form::kJson}}};
  const auto* found = std::ranges::find(kForms, encoding, &std::pair<std::string_view, Form>::first);
  return found == kForms.end() ? std::nullopt : std::optional(found->second);
}

std::optional<MessageReader> MessageReader::for_topic(const Topic& topic) {
  struct Known {
    std::string_view package, name;
    Definition definition;
  };
  constexpr std::array kKnown = std::to_array<Known>({
      {"sensor_msgs", "Image", Definition::kImage},
      {"sensor_msgs", "CompressedImage", Definition::kCompressedImage},
      {"sensor_msgs", "CameraInfo", Definition::kCameraInfo},
      {"ffmpeg_image_transport_msgs", "FFMPEGPacket", Definition::kFfmpegPacket},
      {"foxglove", "RawImage", Definition::kFoxgloveRawImage},
      {"foxglove", "CompressedImage", Definition::kFoxgloveCompressedImage},
      {"foxglove", "CompressedVideo", Definition::kFoxgloveCompressedVideo},
      {"foxglove", "CameraCalibration", Definition::kFoxgloveCameraCalibration},
  });
  const auto form = form_of(topic.encoding);
  if (!form) return std::nullopt;
  const bool of_ros = *form == Form::kCdr || *form == Form::kRos1;
  const std::string_view between = *form == Form::kCdr ? "/msg/" : *form == Form::kRos1 ? "/" : ".";
  for (const Known& known : kKnown) {
    const bool is_foxglove = known.definition >= Definition::kFoxgloveRawImage;
    if (!of_ros && !is_foxglove) continue;
    if (known.definition == Definition::kFfmpegPacket && *form != Form::kCdr) continue;  // that of ROS 1 is another
    std::string type(known.package);
    if (of_ros && is_foxglove) type += "_msgs";
    if (topic.type == type.append(between).append(known.name)) return MessageReader(*form, known.definition);
  }
  return std::nullopt;
}

template <class T>
std::optional<T> MessageReader::read_ros(const std::string& octets) const {
  return form_ == Form::kCdr ? ros::from_cdr<T>(octets_in(octets)) : ros::from_ros1<T>(octets_in(octets));
}

template <class T>
std::optional<T> MessageReader::read_foxglove(const std::string& octets) const {
  if (form_ == Form::kProtobuf) return from_protobuf<T>(octets);
  if (form_ == Form::kJson) return from_json<T>(octets);
  return read_ros<T>(octets);
}

std::string MessageReader::unpacked(std::string octets) const {
  const bool packed = form_ == Form::kCdr && is_zstd(octets);  // CDR begins with a 0
  return packed ? zstd_decompressed_at_most(octets, kMostMessageOctets).value_or("") : std::move(octets);
}

std::optional<TimeNs> MessageReader::stamp_ns(const std::string& octets) const {
  if (is_foxglove()) {
    const auto message = read_foxglove<ros::foxglove::Stamped>(octets);
    return message ? std::optional(ros::ns_of(message->timestamp)) : std::nullopt;
  }
  const auto header = read_ros<ros::Header>(octets);
  return header ? std::optional(ros::ns_of(header->stamp)) : std::nullopt;
}

std::optional<ros::Image> MessageReader::image(const std::string& octets) const {
  if (definition_ == Definition::kImage) return read_ros<ros::Image>(octets);
  if (definition_ != Definition::kFoxgloveRawImage) return std::nullopt;
  auto raw = read_foxglove<ros::foxglove::RawImage>(octets);
  if (!raw) return std::nullopt;
  ros::Image image;
  image.header = {raw->timestamp, std::move(raw->frame_id)};
  image.width = raw->width;
  image.height = raw->height;
  image.encoding = std::move(raw->encoding);
  image.step = raw->step;
  image.data = std::move(raw->data);
  return image;
}

std::optional<ros::CompressedImage> MessageReader::compressed_image(const std::string& octets) const {
  if (definition_ == Definition::kCompressedImage) return read_ros<ros::CompressedImage>(octets);
  if (definition_ == Definition::kFfmpegPacket) {
    auto packet = read_ros<ros::FfmpegPacket>(octets);
    if (!packet) return std::nullopt;
    const std::string codec = packet->encoding.substr(0, packet->encoding.find(';'));
    return ros::CompressedImage{std::move(packet->header), codec, std::move(packet->data)};
  }
  if (definition_ == Definition::kFoxgloveCompressedImage) {
    auto image = read_foxglove<ros::foxglove::CompressedImage>(octets);
    if (image) return as_ros(std::move(*image));
  } else if (definition_ == Definition::kFoxgloveCompressedVideo) {
    auto image = read_foxglove<ros::foxglove::CompressedVideo>(octets);
    if (image) return as_ros(std::move(*image));
  }
  return std::nullopt;
}

std::optional<ros::CameraInfo> MessageReader::camera_info(const std::string& octets) const {
  if (definition_ == Definition::kCameraInfo) return read_ros<ros::CameraInfo>(octets);
  if (definition_ != Definition::kFoxgloveCameraCalibration) return std::nullopt;
  auto camera = read_foxglove<ros::foxglove::CameraCalibration>(octets);
  if (!camera) return std::nullopt;
  ros::CameraInfo info;
  info.header = {camera->timestamp, std::move(camera->frame_id)};
  info.width = camera->width;
  info.height = camera->height;
  const bool is_fisheye = camera->distortion_model == "kannala_brandt";
  info.distortion_model = is_fisheye ? "equidistant" : std::move(camera->distortion_model);
  info.d = std::move(camera->d);
  info.k = camera->k;
  info.r = camera->r;
  info.p = camera->p;
  return info;
}

}  // namespace coslam::recording
