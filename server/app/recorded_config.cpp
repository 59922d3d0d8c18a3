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

// Settings that another section has since, which took them over from the stage of place recognition.
constexpr std::array kOfDescriptorRequests{"soon_s", "least_period_s", "images_per_s"};

void move_to_descriptor_requests(nlohmann::ordered_json* server) {
  const auto places = server->find("place_recognition");
  if (places == server->end() || !places->is_object()) return;
  nlohmann::ordered_json moved;
  for (const char* key : kOfDescriptorRequests) {
    if (const auto at = places->find(key); at != places->end()) moved[key] = *at;
    places->erase(key);
  }
  if (!moved.empty()) (*server)["descriptor_requests"] = std::move(moved);
}

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
    move_to_descriptor_requests(&*server);
  }
  RecordedConfig config;
  config::load_text(config, recorded.dump(), file);
  return config;
}

}  // namespace coslam
