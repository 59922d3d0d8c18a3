// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/ros/cdr.h"
#include "common/ros/std_messages.h"

// Encoding of ROS 1 messages: numbers one after the other, little endian; strings and lists behind their count. The
// structs are those of ROS 2, whose headers lack the number that headers of ROS 1 begin with.
namespace coslam::ros {

// Trusts nothing, as CdrReader.
class Ros1Reader {
 public:
  explicit Ros1Reader(std::span<const std::uint8_t> octets) : octets_(octets) {}

  bool ok() const { return ok_; }
  template <class T>
  void operator()(const char* /*name*/, T& value) {
    get(value);
  }
  void get(Struct auto& value) { value.fields(value, *this); }
  void get(Header& header) {
    std::uint32_t number = 0;
    get(number);
    header.fields(header, *this);
  }
  template <Number T>
  void get(T& value) {
    const std::uint8_t* from = take(sizeof(T));
    if (from == nullptr) return;
    if constexpr (std::same_as<T, bool>) {
      value = *from != 0;
    } else {
      std::memcpy(&value, from, sizeof(T));
    }
  }
  void get(std::string& text) {
    const std::size_t count = get_count();
    const std::uint8_t* from = take(count);
    if (from != nullptr) text.assign(reinterpret_cast<const char*>(from), count);
  }
  template <class T>
  void get(std::vector<T>& list) {
    const std::size_t count = get_count();
    list.clear();
    if constexpr (Number<T>) {
      if (count > octets_.size() / sizeof(T)) return fail();
      const std::uint8_t* from = take(count * sizeof(T));
      if (from == nullptr || count == 0) return;
      list.resize(count);
      std::memcpy(list.data(), from, count * sizeof(T));
    } else {
      while (ok_ && list.size() < count) get(list.emplace_back());
    }
  }
  template <class T, std::size_t kCount>
  void get(std::array<T, kCount>& list) {
    for (T& item : list) get(item);
  }

 private:
  void fail() { ok_ = false; }
  std::size_t get_count() {
    std::uint32_t count = 0;
    get(count);
    return ok_ ? count : 0;
  }
  const std::uint8_t* take(std::size_t bytes) {
    if (!ok_ || bytes > octets_.size()) {
      fail();
      return nullptr;
    }
    const std::uint8_t* from = octets_.data();
    octets_ = octets_.subspan(bytes);
    return from;
  }

  std::span<const std::uint8_t> octets_;
  bool ok_ = true;
};

// Reads a message; empty: cut off, or not of this type.
template <Struct T>
std::optional<T> from_ros1(std::span<const std::uint8_t> octets) {
  T message;
  Ros1Reader reader(octets);
  reader.get(message);
  return reader.ok() ? std::optional(std::move(message)) : std::nullopt;
}

}  // namespace coslam::ros
