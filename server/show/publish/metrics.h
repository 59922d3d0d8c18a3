// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include "server/show/publish/snapshot.h"

// Figures for Prometheus, in its text form (version 0.0.4).
namespace coslam {

class MetricsText {
 public:
  enum class Kind : std::uint8_t { kGauge, kCounter, kSummary };
  using Label = std::pair<std::string_view, std::string_view>;

  // Begins a figure; its values follow.
  void begin(std::string_view name, Kind kind, std::string_view help);
  void value(double value, std::initializer_list<Label> labels = {}, std::string_view suffix = {});
  // Writes a metric with a single value.
  void one(std::string_view name, Kind kind, std::string_view help, double number) {
    begin(name, kind, help);
    value(number);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_, name_;
};

inline constexpr std::string_view kMetricsType = "text/plain; version=0.0.4; charset=utf-8";

// Writes the metrics of the run. Every kind of loss is counted.
void put_metrics(const PublicState& state, MetricsText* text);

}  // namespace coslam
