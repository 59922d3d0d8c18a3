// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/recording/recording.h"

namespace coslam::recording::test {

// All messages of the topic of that name, from the start.
inline std::vector<std::string> played(Recording& recording, std::string_view name) {
  std::vector<std::string> octets;
  for (std::size_t i = 0; i < recording.topics().size(); ++i) {
    if (recording.topics()[i].name != name) continue;
    recording.play(i);
    while (const auto message = recording.next()) octets.push_back(message->octets);
  }
  return octets;
}

inline std::vector<std::string> numbers(int from, int to, int step = 1) {
  std::vector<std::string> texts;
  for (int i = from; i < to; i += step) texts.push_back(std::to_string(i));
  return texts;
}

}  // namespace coslam::recording::test
