// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/metrics.h"

#include <array>
#include <cmath>

#include "common/base/text.h"

namespace coslam {
namespace {

using Kind = MetricsText::Kind;

constexpr double kMs_per_s = 1000, kBytes_per_mib = 1 << 20;

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\' || c == '"') out += '\\';
    if (c == '\n') {
      out += "\\n";
    } else {
      out += c;
    }
  }
  return out;
}

void put_times(const PublicState& state, MetricsText* text) {
  text->begin("coslam_stage_seconds", Kind::kSummary,
              "Time of each stage of a frame set; frame_set is all of them, quantiles are of the whole run; view, "
              "processor time, comes on top");
  for (const auto& [name, t] : state.stages) {
    for (const auto& [quantile, ms] : {std::pair{"0.5", t.p50}, std::pair{"0.95", t.p95}, std::pair{"0.99", t.p99}})
      text->value(ms / kMs_per_s, {{"stage", name}, {"quantile", quantile}});
    text->value(t.sum / kMs_per_s, {{"stage", name}}, "_sum");
    text->value(static_cast<double>(t.count), {{"stage", name}}, "_count");
  }
}

void put_map(const PublicState& state, MetricsText* text) {
  const auto gauge = [&](std::string_view name, std::string_view help, double value) {
    text->one(name, Kind::kGauge, help, value);
  };
  const auto count = [&](std::string_view name, std::string_view help, double value) {
    text->one(name, Kind::kCounter, help, value);
  };
  gauge("coslam_points", "Points of all maps", static_cast<double>(state.points));
  gauge("coslam_moving_points", "Those that move", static_cast<double>(state.moving_points));
  gauge("coslam_objects", "Objects that move", static_cast<double>(state.objects));
  gauge("coslam_maps", "Maps that have not met", static_cast<double>(state.maps));
  gauge("coslam_groups", "Groups of cameras that see common points", static_cast<double>(state.groups.size()));
  gauge("coslam_key_frames", "Key frames", static_cast<double>(state.key_frames));
  gauge("coslam_scale_known", "1: lengths of the largest map are metres", state.scale_known ? 1 : 0);
  gauge("coslam_resident_bytes", "Memory of the map server", state.loop.memory_mib * kBytes_per_mib);
  count("coslam_frame_sets_total", "Frame sets used", state.frame_sets);
  count("coslam_merges_total", "Maps that became part of another", state.merges);
  count("coslam_inter_pose_total", "Joint pose estimates", state.inter_pose_calls);
  count("coslam_adjustments_total", "Bundle adjustments taken in", state.refinements);
}

void put_losses(const PublicState& state, MetricsText* text) {
  text->begin("coslam_lost_total", Kind::kCounter,
              "Frames, frame sets and replies that were not used, by what became of them");
  for (const auto& [cause, n] : state.loop.lost) text->value(static_cast<double>(n), {{"what", cause}});
  text->begin("coslam_rejected_total", Kind::kCounter, "Samples and datagrams that were not used, by reason");
  for (const auto& [reason, n] : state.loop.rejected) text->value(static_cast<double>(n), {{"reason", reason}});
}

void put_agents(const PublicState& state, MetricsText* text) {
  const auto each = [&](std::string_view name, Kind kind, std::string_view help, auto&& value_of) {
    text->begin(name, kind, help);
    for (const PublicAgent& a : state.agents) text->value(value_of(a), {{"agent", a.facts.name}});
  };
  each("coslam_agent_alive", Kind::kGauge, "1: it takes part", [](const auto& a) { return a.alive ? 1.0 : 0.0; });
  each("coslam_agent_has_pose", Kind::kGauge, "1: it has a place in a map",
       [](const auto& a) { return a.cam_from_map ? 1.0 : 0.0; });
  each("coslam_agent_map", Kind::kGauge, "Number of the map that it is in; 0: none",
       [](const auto& a) { return static_cast<double>(a.map.value); });
  each("coslam_agent_tracks", Kind::kGauge, "Features followed",
       [](const auto& a) { return static_cast<double>(a.tracks); });
  each("coslam_agent_bound_tracks", Kind::kGauge, "Those that show a point of the map",
       [](const auto& a) { return static_cast<double>(a.bound); });
  each("coslam_agent_frame_seconds", Kind::kGauge, "Mean time of one frame on the agent",
       [](const auto& a) { return static_cast<double>(a.facts.status.frame_ms) / kMs_per_s; });
  each("coslam_agent_lag_seconds", Kind::kGauge, "How much longer than at best its newest frame was under way",
       [](const auto& a) { return a.facts.wait_s; });
  each("coslam_agent_clock_offset_seconds", Kind::kGauge, "Of its clock, as far as it is known; NaN: not yet",
       [](const auto& a) { return a.clock_offset_s.value_or(std::nan("")); });
  each("coslam_agent_images_doubted", Kind::kGauge, "1: its images are not to be believed now",
       [](const auto& a) { return a.facts.status.image_fault == ImageFault::kNone ? 0.0 : 1.0; });
  each("coslam_agent_path_sigma_ratio", Kind::kGauge,
       "Error of its path that its images leave to be expected, over its length; NaN: not known", [](const auto& a) {
         constexpr double kPercent = 100;
         const auto percent = a.facts.path ? a.facts.path->sigma_percent() : std::nullopt;
         return percent.value_or(std::nan("")) / kPercent;
       });
  text->begin("coslam_agent_images_total", Kind::kCounter, "Images of its source, by what became of them");
  for (const PublicAgent& a : state.agents) {
    for (std::size_t i = 0; i < kImageFates; ++i) {
      const auto fate = static_cast<ImageFate>(i);
      text->value(static_cast<double>(a.facts.images[fate]), {{"agent", a.facts.name}, {"fate", words_of(fate).name}});
    }
  }
  text->begin("coslam_agent_bytes_total", Kind::kCounter, "Between it and the server");
  for (const PublicAgent& a : state.agents) {
    text->value(static_cast<double>(a.facts.bytes_up), {{"agent", a.facts.name}, {"direction", "up"}});
    text->value(static_cast<double>(a.facts.bytes_down), {{"agent", a.facts.name}, {"direction", "down"}});
  }
}

}  // namespace

void MetricsText::begin(std::string_view name, Kind kind, std::string_view help) {
  constexpr std::array<std::string_view, 3> kKinds{"gauge", "counter", "summary"};
  name_ = name;
  text_ += "# HELP " + name_ + " " + std::string(help) + "\n# TYPE " + name_ + " ";
  text_ += kKinds.at(static_cast<std::size_t>(kind));
  text_ += '\n';
}

void MetricsText::value(double value, std::initializer_list<Label> labels, std::string_view suffix) {
  text_ += name_;
  text_ += suffix;
  const char* before = "{";
  for (const auto& [label, content] : labels) {
    text_ += before + std::string(label) + "=\"" + escaped(content) + '"';
    before = ",";
  }
  if (labels.size() > 0) text_ += '}';
  text_ += ' ' + (std::isnan(value) ? "NaN" : format_double(value)) + '\n';
}

void put_metrics(const PublicState& state, MetricsText* text) {
  put_map(state, text);
  put_times(state, text);
  put_losses(state, text);
  put_agents(state, text);
}

}  // namespace coslam
