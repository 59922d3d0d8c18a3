// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

// Public message types of ROS 2 as plain structs. kType is the package and the name; fields() lists the members in the
// order of the definition, for whoever writes, reads or describes them (cdr.h, type.h).
namespace coslam::ros {

struct Time {
  static constexpr const char* kType = "builtin_interfaces/Time";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  static void fields(auto& m, auto& visit) {
    visit("sec", m.sec);
    visit("nanosec", m.nanosec);
  }
};

struct Duration {
  static constexpr const char* kType = "builtin_interfaces/Duration";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  static void fields(auto& m, auto& visit) {
    visit("sec", m.sec);
    visit("nanosec", m.nanosec);
  }
};

struct Header {
  static constexpr const char* kType = "std_msgs/Header";
  Time stamp;
  std::string frame_id;
  static void fields(auto& m, auto& visit) {
    visit("stamp", m.stamp);
    visit("frame_id", m.frame_id);
  }
};

struct String {
  static constexpr const char* kType = "std_msgs/String";
  std::string data;
  static void fields(auto& m, auto& visit) { visit("data", m.data); }
};

struct ColorRGBA {
  static constexpr const char* kType = "std_msgs/ColorRGBA";
  float r = 0, g = 0, b = 0, a = 0;
  static void fields(auto& m, auto& visit) {
    visit("r", m.r);
    visit("g", m.g);
    visit("b", m.b);
    visit("a", m.a);
  }
};

}  // namespace coslam::ros
