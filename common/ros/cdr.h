// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

// Plain CDR (XCDR1, little endian) of structs that list their fields in fields(): what ROS 2 nodes write and read. Four
// octets say how the rest is encoded; numbers stand at multiples of their size, counted from there.
namespace coslam::ros {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie in memory");
inline constexpr std::array<std::uint8_t, 4> kEncapsulation = {0, 1, 0, 0};

template <class T>
concept Number = std::is_arithmetic_v<T>;
template <class T>
concept Struct = requires {
  T::kType;
};

class CdrWriter {
 public:
  CdrWriter() : octets_(kEncapsulation.begin(), kEncapsulation.end()) {}

  template <class T>
  void operator()(const char* /*name*/, const T& value) {
    put(value);
  }
  void put(const Struct auto& value) { value.fields(value, *this); }
  template <Number T>
  void put(T value) {
    align(sizeof(T));
    append(&value, sizeof(T));
  }
  void put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    append(text.c_str(), text.size() + 1);
  }
  template <class T>
  void put(const std::vector<T>& list) {
    put(static_cast<std::uint32_t>(list.size()));
    put_items(std::span(list));
  }
  template <class T, std::size_t kCount>
  void put(const std::array<T, kCount>& list) {
    put_items(std::span<const T>(list));
  }

  std::vector<std::uint8_t> take() { return std::move(octets_); }

 private:
  template <class T>
  void put_items(std::span<const T> items) {
    if constexpr (Number<T>) {
      if (items.empty()) return;  // an empty list needs no alignment
      align(sizeof(T));
      append(items.data(), items.size_bytes());
    } else {
      for (const T& item : items) put(item);
    }
  }
  void align(std::size_t size) {
    const std::size_t over = (octets_.size() - kEncapsulation.size()) % size;
    if (over != 0) octets_.resize(octets_.size() + size - over);
  }
  void append(const void* data, std::size_t bytes) {
    const auto* from = static_cast<const std::uint8_t*>(data);
    octets_.insert(octets_.end(), from, from + bytes);
  }

  std::vector<std::uint8_t> octets_;
};

// Trusts nothing: after the first thing that is not there all reads do nothing and ok() is false. Lists grow as their
// items are read, so that a count that lies takes no memory.
class CdrReader {
 public:
  explicit CdrReader(std::span<const std::uint8_t> octets)
      : octets_(octets),
        at_(kEncapsulation.size()),
        ok_(octets.size() >= kEncapsulation.size() && octets[0] == kEncapsulation[0] &&
            octets[1] == kEncapsulation[1]) {}

  bool ok() const { return ok_; }
  template <class T>
  void operator()(const char* /*name*/, T& value) {
    get(value);
  }
  void get(Struct auto& value) { value.fields(value, *this); }
  template <Number T>
  void get(T& value) {
    align(sizeof(T));
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
    if (from == nullptr) return;
    if (count > 0 && from[count - 1] != 0) return fail();
    text.assign(reinterpret_cast<const char*>(from), count == 0 ? 0 : count - 1);  // some writers leave the 0 out
  }
  template <class T>
  void get(std::vector<T>& list) {
    const std::size_t count = get_count();
    list.clear();
    if constexpr (Number<T>) {
      if (count == 0) return;
      align(sizeof(T));
      if (count > (octets_.size() - at_) / sizeof(T)) return fail();
      const std::uint8_t* from = take(count * sizeof(T));
      if (from == nullptr) return;
      list.resize(count);
      std::memcpy(list.data(), from, count * sizeof(T));
    } else {
      while (ok_ && list.size() < count) get(list.emplace_back());
    }
  }
  // Gives the octets as a view into the input.
  void get(std::span<const std::uint8_t>& octets) {
    const std::size_t count = get_count();
    const std::uint8_t* from = take(count);
    octets = from == nullptr ? std::span<const std::uint8_t>() : std::span(from, count);
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
  void align(std::size_t size) {
    const std::size_t over = (at_ - kEncapsulation.size()) % size;
    if (over != 0) take(size - over);
  }
  const std::uint8_t* take(std::size_t bytes) {
    if (!ok_ || bytes > octets_.size() - at_) {
      fail();
      return nullptr;
    }
    at_ += bytes;
    return octets_.data() + at_ - bytes;
  }

  std::span<const std::uint8_t> octets_;
  std::size_t at_;  // never behind the end while ok_
  bool ok_;
};

template <Struct T>
std::vector<std::uint8_t> to_cdr(const T& message) {
  CdrWriter writer;
  writer.put(message);
  return writer.take();
}

// Reads a message; empty: no little-endian CDR, cut off, or not of this type. Octets behind the message are ignored, as
// DDS pads it.
template <Struct T>
std::optional<T> from_cdr(std::span<const std::uint8_t> octets) {
  T message;
  CdrReader reader(octets);
  reader.get(message);
  return reader.ok() ? std::optional(std::move(message)) : std::nullopt;
}

}  // namespace coslam::ros
