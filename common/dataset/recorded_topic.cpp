// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/recorded_topic.h"

#include <algorithm>

#include "common/base/error.h"

namespace coslam {
namespace {

bool fits(const mcap::Reader& reader, const mcap::Channel& channel, const std::vector<std::string>& types) {
  return channel.encoding == "cdr" && std::ranges::count(types, reader.schema_of(channel).name) > 0;
}

std::string listed(const std::vector<const mcap::Channel*>& channels) {
  std::string text;
  for (const mcap::Channel* c : channels) text += (text.empty() ? "" : ", ") + c->topic;
  return text.empty() ? "none" : text;
}

// The one that was meant, and whatever else has images or lenses, in forms that are not read.
std::string in_other_forms(const mcap::Reader& reader, const RecordedTopic& topic,
                           const std::vector<std::string>& types) {
  std::string text;
  for (const auto& [id, channel] : reader.channels()) {
    if (fits(reader, channel, types)) continue;
    const std::string& type = reader.schema_of(channel).name;
    const bool like = type.find("Image") != type.npos || type.find("Video") != type.npos;
    if (channel.topic != topic.topic && !like) continue;
    text += (text.empty() ? "" : ", ") + channel.topic + " (" + (type.empty() ? "no type" : type) + " in " +
            (channel.encoding.empty() ? "no encoding" : channel.encoding) + ")";
  }
  return text.empty() ? "" : "; there, but not in a form that is read: " + text;
}

}  // namespace

RecordedTopic recorded_topic(const std::string& name) {
  const std::string rest = name.substr(kMcapScheme.size());
  const std::size_t mark = rest.rfind('#');
  if (mark == std::string::npos) return {rest, ""};
  return {rest.substr(0, mark), rest.substr(mark + 1)};
}

const mcap::Channel& recorded_channel(const mcap::Reader& reader, const RecordedTopic& topic,
                                      const std::vector<std::string>& types) {
  std::vector<const mcap::Channel*> there;
  for (const auto& [id, channel] : reader.channels()) {
    if (!fits(reader, channel, types)) continue;
    if (channel.topic == topic.topic) return channel;
    there.push_back(&channel);
  }
  if (topic.topic.empty() && there.size() == 1) return *there.front();
  std::string kinds;
  for (const std::string& type : types) kinds += (kinds.empty() ? "" : " or ") + type;
  throw UserError(topic.file.string() + ": " +
                  (topic.topic.empty() ? "no topic is named (mcap:FILE#TOPIC)" : "there is no topic " + topic.topic) +
                  " of " + kinds + "; of these there are: " + listed(there) + in_other_forms(reader, topic, types));
}

}  // namespace coslam
