// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/ros/cdr.h"

// Names and definitions of message types, derived from their structs.
namespace coslam::ros {

struct TypeText {
  std::string name;      // "sensor_msgs/msg/PointCloud2", as ROS 2 tools, MCAP and the WebSocket name it
  std::string dds_name;  // "sensor_msgs::msg::dds_::PointCloud2_", as ROS 2 nodes name it over DDS
  std::string schema;    // ros2msg: its definition, then those of its parts, each after a line of 80 '='
};

// Collects the definitions of a struct and its parts.
class SchemaWriter {
 public:
  template <Struct T>
  static std::string schema_of() {
    SchemaWriter writer;
    const T message;
    message.fields(message, writer);
    std::string text = std::move(writer.text_);
    for (const auto& [type, definition] : writer.parts_) {
      text.append(80, '=').append("\nMSG: ").append(type).append("\n").append(definition);
    }
    return text;
  }

  template <class T>
  void operator()(const char* name, const T& value) {
    text_ += type_of(value) + " " + name + "\n";
  }

 private:
  template <class T>
  std::string type_of(const std::vector<T>& /*list*/) {
    return type_of(T()) + "[]";
  }
  template <class T, std::size_t kCount>
  std::string type_of(const std::array<T, kCount>& /*list*/) {
    return type_of(T()) + "[" + std::to_string(kCount) + "]";
  }
  static std::string type_of(const std::string& /*text*/) { return "string"; }
  template <Number T>
  static std::string type_of(T /*number*/) {
    if constexpr (std::is_same_v<T, bool>) return "bool";
    const std::string bits = std::to_string(8 * sizeof(T));
    if constexpr (std::is_floating_point_v<T>) return "float" + bits;
    return (std::is_unsigned_v<T> ? "uint" : "int") + bits;
  }
  template <Struct T>
  std::string type_of(const T& value) {
    std::string type = T::kType;
    if (std::ranges::find(parts_, type, &Part::first) != parts_.end()) return type;
    const std::size_t place = parts_.size();
    parts_.emplace_back(type, "");
    std::string outer = std::exchange(text_, {});
    value.fields(value, *this);
    parts_[place].second = std::exchange(text_, std::move(outer));
    return type;
  }

  using Part = std::pair<std::string, std::string>;
  std::string text_;
  std::vector<Part> parts_;
};

template <Struct T>
const TypeText& type_text() {
  static const TypeText kText = [] {
    const std::string type = T::kType;
    const std::size_t slash = type.find('/');
    const std::string package = type.substr(0, slash), name = type.substr(slash + 1);
    return TypeText{package + "/msg/" + name, package + "::msg::dds_::" + name + "_", SchemaWriter::schema_of<T>()};
  }();
  return kText;
}

// Finds one of the messages in messages.h by its name; null: not one of them.
const TypeText* find_type(std::string_view name);

// DDS topic of a ROS 2 topic: "/left/image_raw" becomes "rt/left/image_raw".
std::string dds_topic_of(const std::string& topic);
// ROS 2 topic of a DDS topic; empty: not a topic of messages.
std::optional<std::string> topic_of_dds(std::string_view dds_topic);
// "sensor_msgs/msg/Image" of "sensor_msgs::msg::dds_::Image_"; other names stay as they are.
std::string type_of_dds(const std::string& dds_type);

}  // namespace coslam::ros
