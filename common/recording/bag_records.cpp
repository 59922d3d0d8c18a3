// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recording/bag_records.h"

#include <cstring>

#include "common/mcap/records.h"

namespace coslam::recording {

std::optional<BagFields> BagFields::read(std::string_view header) {
  BagFields fields;
  mcap::OctetReader in(header);
  while (!in.rest().empty()) {
    const std::string_view field = in.get_text();
    const std::size_t equals = field.find('=');
    if (!in.ok() || equals == std::string_view::npos) return std::nullopt;
    fields.fields_.emplace(field.substr(0, equals), field.substr(equals + 1));
  }
  return fields;
}

BagOp BagFields::op() const { return value<BagOp>("op").value_or(BagOp::kNone); }

std::string_view BagFields::text(std::string_view name) const {
  const auto found = fields_.find(name);
  return found == fields_.end() ? std::string_view() : found->second;
}

std::optional<std::uint32_t> BagFields::number(std::string_view name) const { return value<std::uint32_t>(name); }

std::optional<std::uint64_t> BagFields::long_number(std::string_view name) const { return value<std::uint64_t>(name); }

std::optional<TimeNs> BagFields::time_ns(std::string_view name) const {
  constexpr TimeNs kSecond_ns = 1'000'000'000;
  const auto both = value<std::uint64_t>(name);  // seconds, then nanoseconds, of four octets each
  if (!both) return std::nullopt;
  return static_cast<TimeNs>(*both & UINT32_MAX) * kSecond_ns + static_cast<TimeNs>(*both >> 32U);
}

template <class T>
std::optional<T> BagFields::value(std::string_view name) const {
  const std::string_view octets = text(name);
  if (octets.size() != sizeof(T)) return std::nullopt;
  T value{};
  std::memcpy(&value, octets.data(), sizeof(T));
  return value;
}

}  // namespace coslam::recording
