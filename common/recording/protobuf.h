// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/ros/cdr.h"
#include "common/ros/std_messages.h"

// Protobuf's wire format (https://protobuf.dev/programming-guides/encoding) of structs that list their fields and the
// numbers of these in kNumbers.
namespace coslam::recording {

struct ProtobufField {
  std::uint64_t number = 0;
  std::uint64_t value = 0;  // value of a varint, or of 4 or 8 octets
  std::string_view octets;  // content of a text, list or message
};

// The fields of a message in the order in which they stand; empty: damaged, or of a kind that is no longer written.
std::optional<std::vector<ProtobufField>> protobuf_fields(std::string_view message);

// Takes the fields of one message into a struct. What is not there stays as it is; of what is there twice the last
// counts.
class ProtobufReader {
 public:
  ProtobufReader(const std::vector<ProtobufField>& fields, const int* numbers) : fields_(fields), number_(numbers) {}

  bool ok() const { return ok_; }
  template <class T>
  void operator()(const char* /*name*/, T& value) {
    const auto number = static_cast<std::uint64_t>(*number_++);
    for (const ProtobufField& field : fields_) {
      if (field.number == number) get(field, value);
    }
  }
  template <std::size_t kCount>
  void operator()(const char* name, std::array<double, kCount>& numbers) {
    std::vector<double> list;
    (*this)(name, list);
    ok_ = ok_ && (list.empty() || list.size() == kCount);
    if (ok_) std::ranges::copy(list, numbers.begin());
  }

 private:
  void get(const ProtobufField& field, ros::Time& time) {
    const auto parts = protobuf_fields(field.octets);
    ok_ = ok_ && parts;
    if (!parts) return;
    for (const ProtobufField& part : *parts) {
      if (part.number == 1) time.sec = static_cast<std::int32_t>(part.value);
      if (part.number == 2) time.nanosec = static_cast<std::uint32_t>(part.value);
    }
  }
  void get(const ProtobufField& field, std::uint32_t& number) { number = static_cast<std::uint32_t>(field.value); }
  void get(const ProtobufField& field, std::string& text) { text = field.octets; }
  void get(const ProtobufField& field, std::vector<std::uint8_t>& octets) {
    octets.assign(field.octets.begin(), field.octets.end());
  }
  // Packed into one field, or one by one.
  void get(const ProtobufField& field, std::vector<double>& numbers) {
    if (field.octets.data() == nullptr) {
      double number = 0;
      std::memcpy(&number, &field.value, sizeof number);
      numbers.push_back(number);
      return;
    }
    ok_ = ok_ && field.octets.size() % sizeof(double) == 0;
    const std::size_t count = field.octets.size() / sizeof(double), before = numbers.size();
    numbers.resize(before + count);
    if (count > 0) std::memcpy(numbers.data() + before, field.octets.data(), count * sizeof(double));
  }

  const std::vector<ProtobufField>& fields_;
  const int* number_;
  bool ok_ = true;
};

// Reads a message from Protobuf; empty: damaged, or not of this type.
template <ros::Struct T>
std::optional<T> from_protobuf(std::string_view octets) {
  const auto fields = protobuf_fields(octets);
  if (!fields) return std::nullopt;
  T message;
  ProtobufReader reader(*fields, T::kNumbers.data());
  message.fields(message, reader);
  return reader.ok() ? std::optional(std::move(message)) : std::nullopt;
}

}  // namespace coslam::recording
