// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/tools/run/outcome.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <system_error>

#include "common/base/error.h"
#include "common/dataset/result.h"

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

// The others by name, so that nobody takes them for a part of the common one.
void print_maps(const std::filesystem::path& out, const nlohmann::json& report) {
  const auto maps = report.find("maps");
  if (maps == report.end() || maps->size() < 2) return;
  std::printf("%zu maps, which could not be brought together; `tracked` and the files in %s are of the common one\n",
              maps->size(), out.c_str());
  for (const nlohmann::json& map : *maps) {
    std::string who;
    for (const auto& [agent, frames] : map["agents"].items()) {
      who += (who.empty() ? "" : ", ") + agent + " (" + frames.dump() + " frames)";
    }
    const std::string where = &map == &maps->front() ? "common map" : "maps/" + map["map"].dump();
    std::printf("  %s: %s\n", where.c_str(), who.c_str());
  }
}

}  // namespace

void make_result_folder(const std::filesystem::path& folder, bool force) {
  const ResultFolder result(folder);
  if (std::filesystem::is_symlink(folder / kLatestRun)) {
    throw UserError(folder.string() + " holds the runs of a server: name another folder with --out");
  }
  if (result.holds_run()) {
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

void print_summary(const std::filesystem::path& out) {
  if (!std::filesystem::exists(ResultFolder(out).report())) return;
  const nlohmann::json report = read_json(ResultFolder(out).report());
  std::printf("%-12s %7s %8s %9s %9s %10s %10s\n", "agent", "frames", "dropped", "tracked", "ms/frame", "kB/s up",
              "kB/s down");
  for (const auto& [name, a] : report["agents"].items()) {
    std::printf("%-12s %7.0f %8.0f %8.1f%% %9.1f %10.1f %10.1f\n", name.c_str(), number(a, "frames"),
                number(a, "dropped"), number(a, "tracked_percent"), number(a, "ms_per_frame"), number(a, "kb_per_s_up"),
                number(a, "kb_per_s_down"));
  }
  const auto& s = report["server"];
  print_maps(out, report);
  if (!report.value("adjusted", true)) std::printf("the map was not adjusted as a whole at the end\n");
  std::printf("server: %.1f ms a frame set (p99 %.0f), %.0f static points, %.0f key frames, %.0f merges\nresult: %s\n",
              number(s, "ms", "frame_set", "mean"), number(s, "ms", "frame_set", "p99"), number(s, "points", "static"),
              number(s, "key_frames"), number(s, "merges"), out.c_str());
}

}  // namespace coslam
