// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/base/ids.h"

// Layout of a RESULT folder, see docs/configuration.md.
namespace coslam {

// The link beside the folders of a server's runs that names the newest.
inline constexpr const char* kLatestRun = "latest";

// Unit of the lengths of a map: a word for headers and screens.
enum class LengthUnit : std::uint8_t { kNotTold, kMetres, kMapUnits };
constexpr LengthUnit unit_of(bool scale_known) { return scale_known ? LengthUnit::kMetres : LengthUnit::kMapUnits; }
constexpr const char* words_of(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::kMetres:
      return "lengths are metres";
    case LengthUnit::kMapUnits:
      return "scale unknown: lengths are in units of the map";
    case LengthUnit::kNotTold:
      break;
  }
  return "lengths are metres where the scale is known";
}

class ResultFolder {
 public:
  explicit ResultFolder(std::filesystem::path folder) : run_(std::move(folder)), map_(run_) {}
  // Folder of a map that has no known relation to the common one: its coordinates and its unit of length are its own.
  // Files of the whole run stay in the run's folder.
  ResultFolder of_map(MapId map) const { return {run_, run_ / "maps" / std::to_string(map.value)}; }
  // Maps beside the common one that have a folder; ascending.
  std::vector<MapId> map_folders() const;

  // Files of the map: the common one, or that of of_map().
  const std::filesystem::path& path() const { return map_; }
  std::filesystem::path trajectory(const std::string& agent) const { return map_ / "trajectory" / (agent + ".tum"); }
  std::filesystem::path live(const std::string& agent) const { return map_ / "live" / (agent + ".tum"); }
  std::filesystem::path points() const { return map_ / "points.csv"; }
  std::filesystem::path dynamic() const { return map_ / "dynamic.csv"; }
  std::filesystem::path objects() const { return map_ / "objects.csv"; }
  std::filesystem::path map() const { return map_ / "map.ply"; }

  // Files of the run.
  std::filesystem::path tracks(const std::string& agent) const { return run_ / "tracks" / (agent + ".csv"); }
  // Mask of the parts of the image that were found to move with the camera and are left out: black.
  std::filesystem::path own_body(const std::string& agent) const { return run_ / "own_body" / (agent + ".png"); }
  // The lens as it was found, where the calibration had it wrong or there was none.
  std::filesystem::path calibration(const std::string& agent) const { return run_ / "calibration" / (agent + ".yaml"); }
  std::filesystem::path groups() const { return run_ / "groups.csv"; }
  std::filesystem::path events() const { return run_ / "events.csv"; }
  std::filesystem::path report() const { return run_ / "report.json"; }
  // The sequence that was played, written when recordings were played without one.
  std::filesystem::path sequence() const { return run_ / "sequence.yaml"; }
  std::filesystem::path evaluation() const { return run_ / "eval.json"; }
  std::filesystem::path top_view() const { return run_ / "top_view.png"; }
  // Poses in the frame of a map that became part of another later.
  std::filesystem::path live_before(MapId map, const std::string& agent) const {
    return run_ / "live" / ("map" + std::to_string(map.value)) / (agent + ".tum");
  }

  // Something of a run is in it, whole or not.
  bool holds_run() const;
  // Whether there is a run that can be read, not only the sequence and calibrations that a run starts from.
  bool holds_more_than_inputs() const;
  // The file lies where remove_run() removes it.
  bool would_remove(const std::filesystem::path& file) const;
  // Removes what a run and its evaluation write; other files stay. Throws UserError.
  void remove_run() const;

 private:
  ResultFolder(std::filesystem::path run, std::filesystem::path map) : run_(std::move(run)), map_(std::move(map)) {}

  std::filesystem::path run_, map_;
};

// The RESULT that a user names: a run's folder, or the folder of a server's runs, whose `latest` is taken. Throws
// UserError.
ResultFolder find_result(const std::filesystem::path& named);

// One map of a run, and who has poses in it.
struct ResultMap {
  MapId id;  // 0: not known
  ResultFolder folder;
  std::vector<std::string> agents;  // agents with a trajectory in the folder; ascending
  LengthUnit unit = LengthUnit::kNotTold;
};

struct ResultContents {
  std::vector<std::string> agents;             // agents that took part; ascending
  std::vector<ResultMap> maps;                 // the common one first: there always is one
  std::vector<std::filesystem::path> missing;  // trajectories that the report lists and that are not there
  bool reported = true;                        // false: without report.json, as of a server that was killed
};

// Contents of a result as its report lists them; without a report, as the files in the folder tell. Throws UserError:
// file.
ResultContents contents_of(const ResultFolder& result);

}  // namespace coslam
