// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/time.h"

// The records of ROS 1 bags of version 2.0 (https://wiki.ros.org/Bags/Format/2.0), little endian: a header of named
// fields and data, each behind its length in four octets.
namespace coslam::recording {

inline constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";

enum class BagOp : std::uint8_t {
  kNone = 0,
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

// The fields of a header by their names; views of the octets that they were read from.
class BagFields {
 public:
  // Reads a header; empty: the octets are none.
  static std::optional<BagFields> read(std::string_view header);

  BagOp op() const;
  std::string_view text(std::string_view name) const;  // empty where there is no such field
  // Value of a field; empty where there is no such field, or one of another size.
  std::optional<std::uint32_t> number(std::string_view name) const;
  std::optional<std::uint64_t> long_number(std::string_view name) const;
  std::optional<TimeNs> time_ns(std::string_view name) const;

 private:
  template <class T>
  std::optional<T> value(std::string_view name) const;

  std::map<std::string_view, std::string_view> fields_;
};

}  // namespace coslam::recording
