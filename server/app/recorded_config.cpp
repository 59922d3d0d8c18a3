// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/recorded_config.h"

#include <array>
#include <sstream>
#include <string>
#include <utility>

#include "common/base/log.h"

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

// A setting of an earlier version that is a constant now, with its value.
struct FixedSetting {
  const char* section;
  const char* key;
  double value;
};
constexpr std::array kFixedSettings{
    FixedSetting{"classify", "least_s", 0.23},        FixedSetting{"classify", "neighbour_share", 0.5},
    FixedSetting{"classify", "test_s", 1.0},          FixedSetting{"correct", "moving_patch_refresh_s", 0.33},
    FixedSetting{"inter_pose", "hull_area_min", 0.2}, FixedSetting{"map_intra", "min_track_s", 2.0},
    FixedSetting{"objects", "min_path_s", 0.2},       FixedSetting{"window_pose", "free_s", 0.4},
    FixedSetting{"window_pose", "seen_s", 4.0}};

// Leaves out settings that are constants now, and warns where the recorded run had another value.
void drop_fixed_settings(nlohmann::ordered_json* server) {
  for (const FixedSetting& fixed : kFixedSettings) {
    const auto section = server->find(fixed.section);
    if (section == server->end() || !section->is_object()) continue;
    const auto at = section->find(fixed.key);
    if (at == section->end()) continue;
    if (*at != fixed.value) {
      std::ostringstream text;
      text << "the recorded run had server." << fixed.section << "." << fixed.key << " = " << at->dump()
           << ", which is no setting any more: the replay has " << fixed.value;
      log_warn(text.str());
    }
    section->erase(fixed.key);
    if (section->empty()) server->erase(fixed.section);
  }
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
    drop_fixed_settings(&*server);
  }
  RecordedConfig config;
  config::load_text(config, recorded.dump(), file);
  return config;
}

}  // namespace coslam
