// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/ros/cdr.h"
#include "common/ros/std_messages.h"

// Messages of Foxglove's schemas in JSON: octets are text in base64.
namespace coslam::recording {

// Decodes base64; empty: something else.
std::optional<std::vector<std::uint8_t>> from_base64(std::string_view text);
// Discarded where it is none, or nested deeper than such messages are.
nlohmann::json parsed_json(std::string_view text);

// Takes the members of one object into a struct; what is not there stays as it is.
class JsonReader {
 public:
  explicit JsonReader(const nlohmann::json& object) : object_(object) {}

  bool ok() const { return ok_; }
  template <class T>
  void operator()(const char* name, T& value) {
    const auto found = object_.find(name);
    if (found != object_.end()) get(*found, value);
  }

 private:
  void get(const nlohmann::json& value, ros::Time& time) {
    time.sec = static_cast<std::int32_t>(whole(value, "sec"));
    time.nanosec = static_cast<std::uint32_t>(whole(value, "nsec"));
  }
  void get(const nlohmann::json& value, std::uint32_t& number) {
    ok_ = ok_ && value.is_number_integer();
    if (ok_) number = static_cast<std::uint32_t>(value.get<std::int64_t>());
  }
  void get(const nlohmann::json& value, std::string& text) {
    ok_ = ok_ && value.is_string();
    if (ok_) text = value.get_ref<const std::string&>();
  }
  void get(const nlohmann::json& value, std::vector<std::uint8_t>& octets) {
    std::string text;
    get(value, text);
    auto decoded = from_base64(text);
    ok_ = ok_ && decoded;
    if (ok_) octets = std::move(*decoded);
  }
  void get(const nlohmann::json& value, std::vector<double>& numbers) {
    ok_ = ok_ && value.is_array() && std::ranges::all_of(value, [](const auto& item) { return item.is_number(); });
    if (ok_) numbers = value.get<std::vector<double>>();
  }
  template <std::size_t kCount>
  void get(const nlohmann::json& value, std::array<double, kCount>& numbers) {
    std::vector<double> list;
    get(value, list);
    ok_ = ok_ && (list.empty() || list.size() == kCount);
    if (ok_) std::ranges::copy(list, numbers.begin());
  }
  std::int64_t whole(const nlohmann::json& object, const char* name) {
    const bool is = object.is_object() && object.contains(name) && object[name].is_number_integer();
    ok_ = ok_ && is;
    return is ? object[name].get<std::int64_t>() : 0;
  }

  const nlohmann::json& object_;
  bool ok_ = true;
};

// Reads a message from JSON; empty: no JSON, or not of this type.
template <ros::Struct T>
std::optional<T> from_json(std::string_view text) {
  const nlohmann::json object = parsed_json(text);
  if (!object.is_object()) return std::nullopt;
  T message;
  JsonReader reader(object);
  message.fields(message, reader);
  return reader.ok() ? std::optional(std::move(message)) : std::nullopt;
}

}  // namespace coslam::recording
