// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recording/protobuf.h"

#include "common/mcap/records.h"

namespace coslam::recording {
namespace {

std::optional<std::uint64_t> varint(mcap::OctetReader& in) {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 64; shift += 7) {
    const auto octet = in.get<std::uint8_t>();
    if (!in.ok()) return std::nullopt;
    value |= static_cast<std::uint64_t>(octet & 0x7fU) << shift;
    if ((octet & 0x80U) == 0) return value;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::vector<ProtobufField>> protobuf_fields(std::string_view message) {
  enum Wire : std::uint8_t { kVarint = 0, kEight = 1, kOctets = 2, kFour = 5 };
  std::vector<ProtobufField> fields;
  mcap::OctetReader in(message);
  while (!in.rest().empty()) {
    const auto key = varint(in);
    if (!key) return std::nullopt;
    ProtobufField field{*key >> 3U, 0, {}};
    switch (*key & 7U) {
      case kVarint:
      case kOctets: {
        const auto value = varint(in);
        if (!value) return std::nullopt;
        field.value = *value;
        if ((*key & 7U) == kOctets) field.octets = in.get_octets(*value);
        break;
      }
      case kEight:
        field.value = in.get<std::uint64_t>();
        break;
      case kFour:
        field.value = in.get<std::uint32_t>();
        break;
      default:
        return std::nullopt;
    }
    if (!in.ok()) return std::nullopt;
    fields.push_back(field);
  }
  return fields;
}

}  // namespace coslam::recording
