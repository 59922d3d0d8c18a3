// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/mcap/reader.h"

// Topics of recordings of ROS 2, which users name mcap:FILE#TOPIC.
namespace coslam {

inline constexpr std::string_view kMcapScheme = "mcap:";

struct RecordedTopic {
  std::filesystem::path file;
  std::string topic;  // empty: the only one that fits
};
// Of a name that begins with kMcapScheme.
RecordedTopic recorded_topic(const std::string& name);

// The channel of that topic, of one of these types ("sensor_msgs/msg/Image"). Throws UserError, one sentence, when
// there is none: which topics there are of these types.
const mcap::Channel& recorded_channel(const mcap::Reader& reader, const RecordedTopic& topic,
                                      const std::vector<std::string>& types);

}  // namespace coslam
