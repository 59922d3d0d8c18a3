// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/report_parts.h"

#include <string>

namespace coslam {

nlohmann::ordered_json json_of(const ImageAccount& images) {
  nlohmann::ordered_json out = {{"captured", images.captured()}};
  for (std::size_t i = 0; i < kImageFates; ++i) {
    out[std::string(words_of(static_cast<ImageFate>(i)).name)] = images.images[i];
  }
  return out;
}

ImageAccount images_of(const nlohmann::json& agent) {
  ImageAccount out;
  const auto images = agent.is_object() ? agent.find("images") : agent.end();
  if (images == agent.end() || !images->is_object()) return out;
  for (std::size_t i = 0; i < kImageFates; ++i) {
    const auto n = images->find(std::string(words_of(static_cast<ImageFate>(i)).name));
    if (n != images->end() && n->is_number_unsigned()) out.images[i] = n->get<std::uint64_t>();
  }
  return out;
}

nlohmann::ordered_json json_of(const StageTimes& times) {
  nlohmann::ordered_json out = nlohmann::ordered_json::object();
  for (const auto& [name, h] : times.stages()) {
    out[name] = {{"p50", h.percentile_ms(50)},
                 {"p95", h.percentile_ms(95)},
                 {"p99", h.percentile_ms(99)},
                 {"mean", h.mean_ms()},
                 {"count", h.count()}};
  }
  return out;
}

nlohmann::ordered_json json_of(const std::vector<Warning>& warnings) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const Warning& w : warnings) {
    const std::string text = nlohmann::json(w.text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    out.push_back({{"text", nlohmann::json::parse(text)}, {"count", w.count}});
  }
  return out;
}

std::vector<Warning> warnings_of(const nlohmann::json& report) {
  std::vector<Warning> out;
  const auto list = report.is_object() ? report.find("warnings") : report.end();
  if (list == report.end() || !list->is_array()) return out;
  for (const nlohmann::json& w : *list) {
    if (!w.is_object() || !w.contains("text") || !w["text"].is_string()) continue;
    const auto count = w.find("count");
    const bool counted = count != w.end() && count->is_number_integer();
    out.push_back({w["text"].get<std::string>(), counted ? count->get<int>() : 1});
  }
  return out;
}

}  // namespace coslam
