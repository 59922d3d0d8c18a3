// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/ros/std_messages.h"

// Foxglove's schemas of images and lenses, in the order of foxglove_msgs; the names are those of its JSON. kNumbers are
// the fields' numbers in its protobuf, in the same order.
namespace coslam::ros::foxglove {

// First field of all these messages.
struct Stamped {
  static constexpr const char* kType = "foxglove_msgs/Stamped";
  static constexpr std::array kNumbers = {1};
  Time timestamp;
  static void fields(auto& m, auto& visit) { visit("timestamp", m.timestamp); }
};

struct CompressedImage {
  static constexpr const char* kType = "foxglove_msgs/CompressedImage";
  static constexpr std::array kNumbers = {1, 4, 2, 3};
  Time timestamp;
  std::string frame_id;
  std::vector<std::uint8_t> data;
  std::string format;
  static void fields(auto& m, auto& visit) {
    visit("timestamp", m.timestamp);
    visit("frame_id", m.frame_id);
    visit("data", m.data);
    visit("format", m.format);
  }
};

struct CompressedVideo {
  static constexpr const char* kType = "foxglove_msgs/CompressedVideo";
  static constexpr std::array kNumbers = {1, 2, 3, 4};
  Time timestamp;
  std::string frame_id;
  std::vector<std::uint8_t> data;
  std::string format;
  static void fields(auto& m, auto& visit) {
    visit("timestamp", m.timestamp);
    visit("frame_id", m.frame_id);
    visit("data", m.data);
    visit("format", m.format);
  }
};

struct RawImage {
  static constexpr const char* kType = "foxglove_msgs/RawImage";
  static constexpr std::array kNumbers = {1, 7, 2, 3, 4, 5, 6};
  Time timestamp;
  std::string frame_id;
  std::uint32_t width = 0, height = 0;
  std::string encoding;
  std::uint32_t step = 0;  // octets a row
  std::vector<std::uint8_t> data;
  static void fields(auto& m, auto& visit) {
    visit("timestamp", m.timestamp);
    visit("frame_id", m.frame_id);
    visit("width", m.width);
    visit("height", m.height);
    visit("encoding", m.encoding);
    visit("step", m.step);
    visit("data", m.data);
  }
};

struct CameraCalibration {
  static constexpr const char* kType = "foxglove_msgs/CameraCalibration";
  static constexpr std::array kNumbers = {1, 9, 2, 3, 4, 5, 6, 7, 8};
  Time timestamp;
  std::string frame_id;
  std::uint32_t width = 0, height = 0;
  std::string distortion_model;
  std::vector<double> d;
  std::array<double, 9> k{}, r{};
  std::array<double, 12> p{};
  static void fields(auto& m, auto& visit) {
    visit("timestamp", m.timestamp);
    visit("frame_id", m.frame_id);
    visit("width", m.width);
    visit("height", m.height);
    visit("distortion_model", m.distortion_model);
    visit("D", m.d);
    visit("K", m.k);
    visit("R", m.r);
    visit("P", m.p);
  }
};

}  // namespace coslam::ros::foxglove
