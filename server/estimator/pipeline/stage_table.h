// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "server/estimator/pipeline/pipeline.h"

// Access of each stage of a pipeline to data, as the signature of its run() says.
namespace coslam {

struct StageAccess {
  std::string name;
  std::vector<std::string> reads;     // "map", "frame set", reports and settings of other stages
  std::vector<std::string> writes;    // verbs of server/estimator/map/keys.h
  std::vector<std::string> settings;  // sections of the configuration
};

namespace stage {

template <class... Stages>
class AccessTable {
 public:
  static std::vector<StageAccess> rows() { return {row<Stages>()...}; }

 private:
  template <class Stage>
  static StageAccess row() {
    StageAccess out{.name = std::string(Stage::kName), .reads = {}, .writes = {}, .settings = {}};
    if constexpr (!std::is_empty_v<typename Stage::Config>) out.settings.push_back(out.name);
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      using Arguments = typename Signature<decltype(&Stage::run)>::Arguments;
      (add<std::remove_reference_t<std::tuple_element_t<I, Arguments>>>(&out), ...);
    }
    (std::make_index_sequence<std::tuple_size_v<typename Signature<decltype(&Stage::run)>::Arguments>>());
    return out;
  }

  // Name of the stage at a position of the list.
  static std::string name_at(std::size_t i) {
    static const std::vector<std::string> names{std::string(Stages::kName)...};
    return names.at(i);
  }

  template <class Argument>
  static void add(StageAccess* out) {
    using T = std::remove_const_t<Argument>;
    if constexpr (std::same_as<T, FrameSet>) {
      out->reads.emplace_back("frame set");
    } else if constexpr (std::derived_from<T, MapPen>) {
      out->reads.emplace_back("map");
      out->writes.insert(out->writes.end(), T::kMay.begin(), T::kMay.end());
    } else if constexpr (std::same_as<T, Map>) {
      out->reads.emplace_back("map");
    } else if constexpr (std::same_as<T, ServerRun>) {
      out->reads.emplace_back("run");
    } else if constexpr (std::same_as<T, HeldFrames>) {
      out->reads.emplace_back("frames that stages hold");
    } else if constexpr (index_of<T, Stages...>() < sizeof...(Stages)) {
      auto& access = std::is_const_v<Argument> ? out->reads : out->writes;
      access.push_back("state of " + name_at(index_of<T, Stages...>()));
    } else if constexpr (std::same_as<T, Workers>) {
      // Workers share in the stage's work; it reads nothing of them.
    } else if constexpr (is_last<T>) {
      using Report = std::remove_cvref_t<decltype(std::declval<T>().of)>;
      out->reads.push_back("`" + name_at(index_of<Report, ReportOf<Stages>...>()) + "` of the set before");
    } else if constexpr (index_of<T, typename Stages::Config...>() < sizeof...(Stages)) {
      out->settings.push_back(name_at(index_of<T, typename Stages::Config...>()));
    } else {
      out->reads.push_back("`" + name_at(index_of<T, ReportOf<Stages>...>()) + "`");
    }
  }
};

template <class Pipeline>
struct AccessOf;
template <class... Stages>
struct AccessOf<Pipeline<Stages...>> : AccessTable<Stages...> {};

}  // namespace stage

// Lists the access of the stages of a pipeline, in its order.
template <class Pipeline>
std::vector<StageAccess> stage_access() {
  return stage::AccessOf<Pipeline>::rows();
}

// Formats the list as a table in Markdown: stage, reads, writes, settings.
inline std::string markdown_of(const std::vector<StageAccess>& stages) {
  const auto joined = [](const std::vector<std::string>& parts, const char* quote) {
    std::string out;
    for (const std::string& part : parts) {
      const char* mark = part.find(' ') == std::string::npos ? quote : "";  // names of code alone
      out += (out.empty() ? "" : ", ") + (mark + part) + mark;
    }
    return out;
  };
  std::string out = "| stage | reads | writes | settings |\n|---|---|---|---|\n";
  for (const StageAccess& s : stages) {
    out += "| `" + s.name + "` | " + joined(s.reads, "") + " | " + joined(s.writes, "`") + " | " +
           joined(s.settings, "`") + " |\n";
  }
  return out;
}

}  // namespace coslam
