// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/result_folder.h"

#include <algorithm>
#include <array>
#include <set>

#include "common/base/error.h"
#include "common/base/file_kind.h"
#include "common/base/text.h"
#include "common/dataset/result.h"

namespace coslam {
namespace {

constexpr std::array<const char*, 14> kOfARun{
    "trajectory", "live",       "tracks",  "calibration", "points.csv", "dynamic.csv",  "objects.csv",
    "groups.csv", "events.csv", "map.ply", "report.json", "eval.json",  "top_view.png", "sequence.yaml"};
// Of these a folder of a sequence has some too.
constexpr std::array<const char*, 2> kOfInputsToo{"calibration", "sequence.yaml"};
constexpr const char* kOwnBody = "own_body";  // is there before its run begins

// Names of the files with this extension in a folder, without it.
std::set<std::string> stems_in(const std::filesystem::path& folder, const char* extension) {
  std::set<std::string> stems;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    if (entry.path().extension() == extension) stems.insert(entry.path().stem().string());
  }
  return stems;
}

std::vector<std::string> list_of(const std::set<std::string>& names) { return {names.begin(), names.end()}; }

ResultMap map_in(const ResultFolder& folder, MapId id, const std::set<std::string>& among) {
  ResultMap map{id, folder, {}};
  for (const std::string& agent : among) {
    if (std::filesystem::exists(folder.trajectory(agent))) map.agents.push_back(agent);
  }
  return map;
}

ResultContents lying_in(const ResultFolder& result) {
  const auto in_map = [](const ResultFolder& folder) { return stems_in(folder.trajectory("").parent_path(), ".tum"); };
  ResultContents contents{.agents = {}, .maps = {map_in(result, MapId(), in_map(result))}, .reported = false};
  for (const MapId id : result.map_folders()) {
    const ResultFolder folder = result.of_map(id);
    contents.maps.push_back(map_in(folder, id, in_map(folder)));
  }
  std::set<std::string> agents = stems_in(result.tracks("").parent_path(), ".csv");
  for (const ResultMap& map : contents.maps) agents.insert(map.agents.begin(), map.agents.end());
  contents.agents = list_of(agents);
  return contents;
}

// Names of the members of an object whose value is not 0: who has so many frames.
std::set<std::string> names_in(const nlohmann::json& object) {
  std::set<std::string> names;
  if (!object.is_object()) return names;
  for (const auto& [name, value] : object.items()) {
    if (value != 0) names.insert(name);
  }
  return names;
}

// Throws what the library throws for values of other types.
ResultContents listed_in(const nlohmann::json& report, const ResultFolder& result) {
  std::set<std::string> agents;
  if (report.contains("agents") && report["agents"].is_object()) {
    for (const auto& [name, agent] : report["agents"].items()) agents.insert(name);
  }
  ResultContents contents;
  contents.agents = list_of(agents);
  if (report.contains("maps") && report["maps"].is_array()) {
    for (const nlohmann::json& map : report["maps"]) {
      const MapId id(map.value("map", 0U));
      const ResultFolder folder = contents.maps.empty() ? result : result.of_map(id);
      const std::set<std::string> placed = names_in(map.value("agents", nlohmann::json()));
      contents.maps.push_back(map_in(folder, id, placed));
      for (const std::string& agent : placed) {
        if (!std::filesystem::exists(folder.trajectory(agent))) contents.missing.push_back(folder.trajectory(agent));
      }
      if (map.contains("scale_known")) contents.maps.back().unit = unit_of(map["scale_known"].get<bool>());
    }
  }
  if (contents.maps.empty()) contents.maps.push_back(map_in(result, MapId(), agents));
  return contents;
}

}  // namespace

std::vector<MapId> ResultFolder::map_folders() const {
  std::vector<MapId> maps;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(run_ / "maps", none)) {
    const auto id = parse_integer(entry.path().filename().string());
    if (entry.is_directory() && id && *id > 0 && *id <= 0xffffffff) maps.emplace_back(static_cast<std::uint32_t>(*id));
  }
  std::sort(maps.begin(), maps.end());
  return maps;
}

bool ResultFolder::holds_run() const {
  return !map_folders().empty() ||
         std::ranges::any_of(kOfARun, [this](const char* name) { return std::filesystem::exists(run_ / name); });
}

bool ResultFolder::holds_more_than_inputs() const {
  return !map_folders().empty() || std::ranges::any_of(kOfARun, [this](const std::string& name) {
    return std::ranges::find(kOfInputsToo, name) == kOfInputsToo.end() && std::filesystem::exists(run_ / name);
  });
}

bool ResultFolder::would_remove(const std::filesystem::path& file) const {
  std::error_code none;
  const auto whole = [&none](const std::filesystem::path& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path, none), none);
  };
  const std::filesystem::path inside = whole(file).lexically_relative(whole(run_));
  const std::string first = inside.empty() ? "" : inside.begin()->string();
  return first == "maps" || first == kOwnBody || std::ranges::find(kOfARun, first) != kOfARun.end();
}

void ResultFolder::remove_run() const {
  const auto remove = [](const std::filesystem::path& left) {
    std::error_code error;
    std::filesystem::remove_all(left, error);
    if (error) throw UserError("cannot remove " + left.string() + ": " + error.message());
  };
  for (const MapId map : map_folders()) remove(of_map(map).path());
  remove(run_ / kOwnBody);
  for (const std::string name : kOfARun) {
    remove(run_ / name);
    remove(run_ / (name + ".new"));
  }
}

ResultFolder find_result(const std::filesystem::path& named) {
  if (!std::filesystem::is_directory(named))
    throw UserError(named.string() + ": there is no such result folder" + but_it_is(named));
  const std::filesystem::path latest = named / kLatestRun;
  if (std::filesystem::is_symlink(latest)) {
    // By its own name: the link may come to name another run any time.
    const std::filesystem::path run = named / std::filesystem::read_symlink(latest);
    if (!std::filesystem::is_directory(run)) throw UserError(latest.string() + " leads to no folder");
    return ResultFolder(run);
  }
  ResultFolder result(named);
  if (!result.holds_more_than_inputs()) {
    throw UserError(named.string() + " holds no run, and no link `" + kLatestRun + "` to the folder of one" +
                    but_it_is(named));
  }
  return result;
}

ResultContents contents_of(const ResultFolder& result) {
  if (!std::filesystem::exists(result.report())) return lying_in(result);
  const nlohmann::json report = read_json(result.report());
  try {
    return listed_in(report, result);
  } catch (const nlohmann::json::exception& e) {
    throw UserError(result.report().string() + ": not the report of a run: " + e.what());
  }
}

}  // namespace coslam
