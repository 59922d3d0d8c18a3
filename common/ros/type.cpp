// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros/type.h"

#include "common/ros/messages.h"

namespace coslam::ros {
namespace {

constexpr std::string_view kTopicPrefix = "rt", kTypeMark = "::dds_::";

template <class... T>
std::vector<const TypeText*> texts_of(const std::tuple<T...>* /*types*/) {
  return {&type_text<T>()...};
}

}  // namespace

const TypeText* find_type(std::string_view name) {
  static const std::vector<const TypeText*> kTexts = texts_of(static_cast<const Messages*>(nullptr));
  const auto found =
      std::ranges::find(kTexts, name, [](const TypeText* text) -> std::string_view { return text->name; });
  return found == kTexts.end() ? nullptr : *found;
}

std::string dds_topic_of(const std::string& topic) { return std::string(kTopicPrefix) + topic; }

std::optional<std::string> topic_of_dds(std::string_view dds_topic) {
  if (!dds_topic.starts_with(std::string(kTopicPrefix) + "/")) return std::nullopt;
  return std::string(dds_topic.substr(kTopicPrefix.size()));
}

std::string type_of_dds(const std::string& dds_type) {
  const std::size_t mark = dds_type.find(kTypeMark);
  if (mark == std::string::npos || !dds_type.ends_with('_')) return dds_type;
  std::string name = dds_type.substr(0, mark);
  for (std::size_t at = name.find("::"); at != std::string::npos; at = name.find("::")) name.replace(at, 2, "/");
  const std::size_t from = mark + kTypeMark.size();
  return name + "/" + dds_type.substr(from, dds_type.size() - from - 1);
}

}  // namespace coslam::ros
