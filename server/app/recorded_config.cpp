// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/recorded_config.h"

#include <array>
#include <string>
#include <utility>

namespace coslam {
namespace {

// Sections of `server` under the names that recordings of before have: each stage has one name since.
constexpr std::array<std::pair<const char*, const char*>, 11> kEarlierNames{{{"refine", "bundle_adjustment"},
                                                                             {"key_frame", "key_frames"},
                                                                             {"find_again", "wide_search"},
                                                                             {"meet", "place_recognition"},
                                                                             {"clock", "clock_offsets"},
                                                                             {"lag", "stamp_lag"},
                                                                             {"group", "grouping"},
                                                                             {"tags", "scale"},
                                                                             {"patches", "correct"},
                                                                             {"moving", "announce_moving"},
                                                                             {"past", "forget"}}};

}  // namespace

RecordedConfig recorded_config(const RecordingHead& head, const std::filesystem::path& file) {
  nlohmann::ordered_json recorded = head.configuration;
  if (const auto server = recorded.find("server"); server != recorded.end() && server->is_object()) {
    for (const auto& [before, now] : kEarlierNames) {
      const auto at = server->find(before);
      if (at == server->end()) continue;
      nlohmann::ordered_json section = std::move(*at);
      server->erase(before);
      (*server)[now] = std::move(section);
    }
  }
  RecordedConfig config;
  config::load_text(config, recorded.dump(), file);
  return config;
}

}  // namespace coslam
