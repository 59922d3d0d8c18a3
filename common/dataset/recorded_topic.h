// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "common/recording/recording.h"

// Topics of recordings, which users name bag:PATH#TOPIC, or mcap:PATH#TOPIC, which means the same.
namespace coslam {

bool names_recorded_topic(std::string_view name);  // tells by the beginning

struct RecordedTopic {
  std::string scheme;  // "bag:" or "mcap:"; empty: it was named by its path alone
  std::filesystem::path path;
  std::string topic;  // empty: the only one that fits
  std::string name() const;
};
// Parses a name that begins with a scheme, or a path; relative ones are from that folder.
RecordedTopic recorded_topic(const std::string& name, const std::filesystem::path& folder = {});

enum class Wanted : std::uint8_t { kImages, kLenses };
// The place of a topic among the recording's, of one for which there is a MessageReader. Throws UserError, one
// sentence, when there is none: which topics there are, and which in a form that is not read.
std::size_t find_topic(const recording::Recording& recording, const RecordedTopic& topic, Wanted wanted);

}  // namespace coslam
