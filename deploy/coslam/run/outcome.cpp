// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/outcome.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/dataset/report_parts.h"
#include "common/dataset/result.h"
#include "server/estimator/reports/place_recognition_report.h"
#include "server/show/publish/event_feed.h"

namespace coslam {
namespace {

double number(const nlohmann::json& j, const char* a, const char* b = nullptr, const char* c = nullptr) {
  const nlohmann::json* at = &j;
  for (const char* key : {a, b, c}) {
    if (key == nullptr) break;
    if (!at->contains(key)) return 0;
    at = &(*at)[key];
  }
  return at->is_number() ? at->get<double>() : 0;
}

// Of the verdict of an agent's path; "-" where there is none.
std::string path_word(const nlohmann::json& agent, const char* key) {
  const auto path = agent.find("path");
  return path == agent.end() || !path->is_object() ? "-" : path->value(key, "-");
}

// Tells why nothing that was recognised brought the maps together.
void print_doubts(const nlohmann::json& events) {
  // In the order of PlaceDoubt.
  constexpr std::array<const char*, kPlaceDoubtCounts.size()> kDoubts{"",
                                                                      "in too few features",
                                                                      "on one flat thing alone",
                                                                      "with depths that disagree",
                                                                      "without a second image that confirms",
                                                                      "with a second image that contradicts"};
  std::string doubts_text;
  for (std::size_t i = 1; i < kDoubts.size(); ++i) {
    const auto count = static_cast<long>(number(events, kPlaceDoubtCounts.at(i)));
    if (count > 0) doubts_text += (doubts_text.empty() ? "" : ", ") + std::to_string(count) + " " + kDoubts.at(i);
  }
  std::printf("  %.0f images were compared with known places; not believed: %s\n", number(events, "images_described"),
              doubts_text.empty() ? "none, as no place was recognised" : doubts_text.c_str());
}

// The others by name, so that nobody takes them for a part of the common one.
void print_maps(const std::filesystem::path& out, const nlohmann::json& report) {
  const auto maps = report.find("maps");
  if (maps == report.end() || maps->size() < 2) return;
  std::printf("%zu maps, which could not be brought together; `tracked` and the files in %s are of the common one\n",
              maps->size(), out.c_str());
  for (const nlohmann::json& map : *maps) {
    std::string agents_text;
    for (const auto& [agent, frames] : map["agents"].items()) {
      agents_text += (agents_text.empty() ? "" : ", ") + agent + " (" + frames.dump() + " frames)";
    }
    const std::string map_name = &map == &maps->front() ? "common map" : "maps/" + map["map"].dump();
    std::printf("  %s: %s\n", map_name.c_str(), agents_text.c_str());
  }
  if (const auto events = report.at("server").find("events"); events != report.at("server").end())
    print_doubts(*events);
}

void print_lenses(const ResultFolder& result, const nlohmann::json& report) {
  for (const auto& [name, agent] : report["agents"].items()) {
    const std::filesystem::path file = result.calibration(name);
    if (std::filesystem::exists(file)) std::printf("the lens of %s as it was found: %s\n", name.c_str(), file.c_str());
  }
}

// What was warned of by anybody: the server, the agents and this process, each once.
void print_warnings(const nlohmann::json& report) {
  std::vector<Warning> all = warnings_of(report);
  const auto add = [&](Warning warning) {
    if (std::ranges::find(all, warning.text, &Warning::text) == all.end()) all.push_back(std::move(warning));
  };
  for (const auto& [name, agent] : report["agents"].items()) {
    for (const Warning& w : warnings_of(agent)) add({"agent " + name + ": " + w.text, w.count});
    // Found when the run was over.
    const auto lag = agent.find("misdated_s");
    const auto tells_lag = [start = name + "'s images seem to be taken"](const Warning& w) {
      return w.text.starts_with(start);
    };
    if (lag != agent.end() && lag->is_number() && std::ranges::none_of(all, tells_lag)) {
      add({misdated_sentence(name, agent["lag"]["against"].get<std::string>(), lag->get<double>()), 1});
    }
  }
  for (const Warning& warning : warnings_given()) add(warning);
  if (!all.empty()) std::printf("warnings:\n");
  for (const Warning& w : all) {
    const std::string times = w.count > 1 ? " (" + std::to_string(w.count) + " times)" : "";
    std::printf("  %s%s\n", w.text.c_str(), times.c_str());
  }
}

}  // namespace

void make_result_folder(const std::filesystem::path& folder, bool force) {
  if (folder.empty()) throw UsageError("--out is empty: it takes the folder for the result");
  const ResultFolder result(folder);
  if (std::filesystem::is_symlink(folder / kLatestRun)) {
    throw UserError(folder.string() + " holds the runs of a server: name another folder with --out");
  }
  if (result.holds_run()) {
    if (!result.holds_more_than_inputs()) {
      throw UserError(folder.string() +
                      " holds a sequence, which a result would replace: name another folder with --out");
    }
    if (!force) {
      throw UserError(folder.string() +
                      " holds a run already: name another folder with --out, or replace it with --force");
    }
    result.remove_run();
  }
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && access(folder.c_str(), W_OK) != 0) error.assign(errno, std::generic_category());
  if (error) throw UserError("cannot make the result folder " + folder.string() + ": " + error.message());
}

bool print_summary(const std::filesystem::path& out) {
  if (!std::filesystem::exists(ResultFolder(out).report())) return true;
  const nlohmann::json report = read_json(ResultFolder(out).report());
  std::printf("%-12s %7s %9s %9s %10s %10s %6s\n", "agent", "images", "tracked", "ms/frame", "kB/s up", "kB/s down",
              "path");
  for (const auto& [name, a] : report["agents"].items()) {
    std::printf("%-12s %7.0f %8.1f%% %9.1f %10.1f %10.1f %6s\n", name.c_str(), number(a, "frames"),
                number(a, "tracked_percent"), number(a, "ms_per_frame"), number(a, "kb_per_s_up"),
                number(a, "kb_per_s_down"), path_word(a, "quality").c_str());
  }
  for (const auto& [name, a] : report["agents"].items()) {
    const ImageAccount images = images_of(a);
    if (!images.losses().empty()) std::printf("%s\n", losses_of(name, images).c_str());
    if (a.contains("problem") && !report.contains("problem")) {
      std::printf("%s\n", a["problem"].get<std::string>().c_str());
    } else if (const std::string why = path_word(a, "why"); why != "-" && !why.empty()) {
      std::printf("%s: its path is %s, as %s\n", name.c_str(), path_word(a, "quality").c_str(), why.c_str());
    }
  }
  const auto& s = report["server"];
  print_maps(out, report);
  if (!report.value("adjusted", true)) std::printf("the map was not adjusted as a whole at the end\n");
  std::printf("server: %.1f ms a frame set (p99 %.0f), %.0f static points, %.0f key frames, %.0f merges\n",
              number(s, "ms", "frame_set", "mean"), number(s, "ms", "frame_set", "p99"), number(s, "points", "static"),
              number(s, "key_frames"), number(s, "merges"));
  if (!report.contains("problem")) std::printf("%s\n", words_of(unit_of(s.value("scale_known", false))));
  std::printf("result: %s\n", out.c_str());
  print_lenses(ResultFolder(out), report);
  print_warnings(report);
  const auto problem = report.find("problem");
  if (problem == report.end()) return true;
  std::fprintf(stderr, "coslam: %s\n", problem->get<std::string>().c_str());
  return false;
}

}  // namespace coslam
