// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/ros/std_messages.h"

// sensor_msgs.
namespace coslam::ros {

struct PointField {
  static constexpr const char* kType = "sensor_msgs/PointField";
  enum Datatype : std::uint8_t {
    kInt8 = 1,
    kUint8 = 2,
    kInt16 = 3,
    kUint16 = 4,
    kInt32 = 5,
    kUint32 = 6,
    kFloat32 = 7,
    kFloat64 = 8
  };
  std::string name;
  std::uint32_t offset = 0;  // octets from the start of the point
  std::uint8_t datatype = 0;
  std::uint32_t count = 1;
  static void fields(auto& m, auto& visit) {
    visit("name", m.name);
    visit("offset", m.offset);
    visit("datatype", m.datatype);
    visit("count", m.count);
  }
};

struct PointCloud2 {
  static constexpr const char* kType = "sensor_msgs/PointCloud2";
  Header header;
  std::uint32_t height = 1, width = 0;
  std::vector<PointField> point_fields;  // "fields" in the definition
  bool is_bigendian = false;
  std::uint32_t point_step = 0, row_step = 0;
  std::vector<std::uint8_t> data;
  bool is_dense = true;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("height", m.height);
    visit("width", m.width);
    visit("fields", m.point_fields);
    visit("is_bigendian", m.is_bigendian);
    visit("point_step", m.point_step);
    visit("row_step", m.row_step);
    visit("data", m.data);
    visit("is_dense", m.is_dense);
  }
};

template <class Octets>
struct ImageWith {
  static constexpr const char* kType = "sensor_msgs/Image";
  Header header;
  std::uint32_t height = 0, width = 0;
  std::string encoding;
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;  // octets a row
  Octets data;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("height", m.height);
    visit("width", m.width);
    visit("encoding", m.encoding);
    visit("is_bigendian", m.is_bigendian);
    visit("step", m.step);
    visit("data", m.data);
  }
};
using Image = ImageWith<std::vector<std::uint8_t>>;
using ImageView = ImageWith<std::span<const std::uint8_t>>;  // read only: the octets stay in the input

struct CompressedImage {
  static constexpr const char* kType = "sensor_msgs/CompressedImage";
  Header header;
  std::string format;
  std::vector<std::uint8_t> data;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("format", m.format);
    visit("data", m.data);
  }
};

// One frame of a video, as ffmpeg_image_transport publishes it in ROS 2.
struct FfmpegPacket {
  static constexpr const char* kType = "ffmpeg_image_transport_msgs/FFMPEGPacket";
  Header header;
  std::int32_t width = 0, height = 0;
  std::string encoding;  // the codec, then, each after a ';', formats of pixels
  std::uint64_t pts = 0;
  std::uint8_t flags = 0;
  bool is_bigendian = false;
  std::vector<std::uint8_t> data;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("width", m.width);
    visit("height", m.height);
    visit("encoding", m.encoding);
    visit("pts", m.pts);
    visit("flags", m.flags);
    visit("is_bigendian", m.is_bigendian);
    visit("data", m.data);
  }
};

struct RegionOfInterest {
  static constexpr const char* kType = "sensor_msgs/RegionOfInterest";
  std::uint32_t x_offset = 0, y_offset = 0, height = 0, width = 0;
  bool do_rectify = false;
  static void fields(auto& m, auto& visit) {
    visit("x_offset", m.x_offset);
    visit("y_offset", m.y_offset);
    visit("height", m.height);
    visit("width", m.width);
    visit("do_rectify", m.do_rectify);
  }
};

struct CameraInfo {
  static constexpr const char* kType = "sensor_msgs/CameraInfo";
  Header header;
  std::uint32_t height = 0, width = 0;
  std::string distortion_model;
  std::vector<double> d;
  std::array<double, 9> k{}, r{};
  std::array<double, 12> p{};
  std::uint32_t binning_x = 0, binning_y = 0;
  RegionOfInterest roi;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("height", m.height);
    visit("width", m.width);
    visit("distortion_model", m.distortion_model);
    visit("d", m.d);
    visit("k", m.k);
    visit("r", m.r);
    visit("p", m.p);
    visit("binning_x", m.binning_x);
    visit("binning_y", m.binning_y);
    visit("roi", m.roi);
  }
};

}  // namespace coslam::ros
