// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/recorded_topic.h"

#include <algorithm>
#include <array>
#include <vector>

#include "common/base/error.h"
#include "common/recording/message_reader.h"

namespace coslam {
namespace {

constexpr std::array<std::string_view, 2> kSchemes = {"mcap:", "bag:"};

std::string_view scheme_of(std::string_view name) {
  const auto* found = std::ranges::find_if(kSchemes, [&](std::string_view s) { return name.starts_with(s); });
  return found == kSchemes.end() ? std::string_view() : *found;
}

bool is_read(const recording::Topic& topic, Wanted wanted) {
  const auto reader = recording::MessageReader::for_topic(topic);
  return reader && (reader->kind() == recording::MessageKind::kCameraInfo) == (wanted == Wanted::kLenses);
}

std::string with_type(const recording::Topic& topic) {
  return topic.name + " (" + (topic.type.empty() ? "no type" : topic.type) + " in " +
         (topic.encoding.empty() ? "no encoding" : topic.encoding) + ")";
}

// What makes of such a topic one that is read; empty where nothing is known.
std::string remedy(const recording::Topic& topic) {
  if (topic.type.starts_with("theora_image_transport/")) {
    return ": image_transport's node republish makes images of it (ros2 run image_transport republish theora raw)";
  }
  return topic.encoding == "ros2" ? ": ros2 bag convert writes it as cdr" : "";
}

// The one that was meant, and whatever else has images, in forms that are not read.
std::string in_other_forms(const recording::Recording& recording, const RecordedTopic& wanted_topic, Wanted wanted) {
  std::string text;
  for (const recording::Topic& topic : recording.topics()) {
    if (is_read(topic, wanted)) continue;
    const std::string& type = topic.type;
    const bool like = !recording::MessageReader::for_topic(topic) &&
                      (type.find("Image") != type.npos || type.find("Video") != type.npos ||
                       type.starts_with("theora_image_transport/"));
    if (topic.name != wanted_topic.topic && !like) continue;
    text += (text.empty() ? "" : ", ") + with_type(topic) + remedy(topic);
  }
  return text.empty() ? "" : "; there, but not in a form that is read: " + text;
}

}  // namespace

bool names_recorded_topic(std::string_view name) { return !scheme_of(name).empty(); }

std::string RecordedTopic::name() const { return scheme + path.string() + (topic.empty() ? "" : "#" + topic); }

RecordedTopic recorded_topic(const std::string& name, const std::filesystem::path& folder) {
  RecordedTopic topic{std::string(scheme_of(name)), {}, ""};
  const std::string rest = name.substr(topic.scheme.size());
  const std::size_t mark = rest.rfind('#');
  std::error_code ignored;
  const bool whole =
      mark == std::string::npos || topic.scheme.empty() || std::filesystem::exists(folder / rest, ignored);
  topic.path = folder / (whole ? rest : rest.substr(0, mark));
  if (!whole) topic.topic = rest.substr(mark + 1);
  return topic;
}

std::size_t find_topic(const recording::Recording& recording, const RecordedTopic& topic, Wanted wanted) {
  std::vector<std::size_t> candidates;
  std::string listed;
  for (std::size_t i = 0; i < recording.topics().size(); ++i) {
    const recording::Topic& candidate = recording.topics()[i];
    if (!is_read(candidate, wanted)) continue;
    if (candidate.name == topic.topic) return i;
    candidates.push_back(i);
    listed += (listed.empty() ? "" : ", ") + candidate.name;
  }
  if (topic.topic.empty() && candidates.size() == 1) return candidates.front();
  const std::string kind = wanted == Wanted::kImages ? "images" : "lenses (CameraInfo)";
  throw UserError(topic.path.string() + ": " +
                  (topic.topic.empty() ? "no topic is named (bag:PATH#TOPIC)" : "there is no topic " + topic.topic) +
                  " of " + kind + "; of these there are: " + (listed.empty() ? "none" : listed) +
                  in_other_forms(recording, topic, wanted));
}

}  // namespace coslam
