// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/ros/cdr.h"
#include "common/ros/std_messages.h"

// Messages as ROS 1 writes them, for tests.
namespace coslam::recording::test {

class Ros1Writer {
 public:
  template <class T>
  void operator()(const char* /*name*/, const T& value) {
    put(value);
  }
  void put(const ros::Struct auto& value) { value.fields(value, *this); }
  void put(const ros::Header& header) {
    put(std::uint32_t{0});
    header.fields(header, *this);
  }
  template <ros::Number T>
  void put(T value) {
    octets_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    octets_ += text;
  }
  template <class T>
  void put(const std::vector<T>& list) {
    put(static_cast<std::uint32_t>(list.size()));
    for (const T& item : list) put(item);
  }
  template <class T, std::size_t kCount>
  void put(const std::array<T, kCount>& list) {
    for (const T& item : list) put(item);
  }
  const std::string& octets() const { return octets_; }

 private:
  std::string octets_;
};

template <ros::Struct T>
std::string to_ros1(const T& message) {
  Ros1Writer writer;
  writer.put(message);
  return writer.octets();
}

template <ros::Struct T>
std::string to_cdr_text(const T& message) {
  const auto octets = ros::to_cdr(message);
  return {octets.begin(), octets.end()};
}

}  // namespace coslam::recording::test
