// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

// Packed octets, little endian. For the codec and for files of messages.
namespace coslam {

static_assert(std::endian::native == std::endian::little, "packed octets are copied as they lie in memory");

class Packer {
 public:
  explicit Packer(std::vector<std::uint8_t>& out) : out_(out) {}

  template <class T>
  void put(T value) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
    out_.insert(out_.end(), bytes, bytes + sizeof(T));
  }

  // Seven bits an octet, low ones first; the high bit says that more follow.
  void put_varint(std::uint32_t value) {
    for (; value >= 0x80; value >>= 7) out_.push_back(static_cast<std::uint8_t>(value | 0x80));
    out_.push_back(static_cast<std::uint8_t>(value));
  }

 private:
  std::vector<std::uint8_t>& out_;
};

// Reads values from octets; every read may fail, and is empty at their end.
class Unpacker {
 public:
  explicit Unpacker(std::span<const std::uint8_t> in) : in_(in) {}

  std::size_t left() const { return in_.size(); }

  template <class T>
  std::optional<T> get() {
    if (in_.size() < sizeof(T)) return std::nullopt;
    T value;
    std::memcpy(&value, in_.data(), sizeof(T));
    in_ = in_.subspan(sizeof(T));
    return value;
  }

  // Reads a varint; empty also when the number does not fit 32 bits or is written longer than needed.
  std::optional<std::uint32_t> get_varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 35; shift += 7) {
      const auto byte = get<std::uint8_t>();
      if (!byte) return std::nullopt;
      value |= static_cast<std::uint64_t>(*byte & 0x7f) << shift;
      if ((*byte & 0x80) != 0) continue;
      const bool overlong = *byte == 0 && shift > 0;
      return overlong || value > UINT32_MAX ? std::nullopt : std::optional(static_cast<std::uint32_t>(value));
    }
    return std::nullopt;
  }

 private:
  std::span<const std::uint8_t> in_;
};

}  // namespace coslam
