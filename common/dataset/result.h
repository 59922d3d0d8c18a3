// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/model/map_patch.h"

// The files of a RESULT folder, see docs/configuration.md. Readers throw UserError with file and line.
namespace coslam {

// Where each file of a result lies.
class ResultFolder {
 public:
  explicit ResultFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}
  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path trajectory(const std::string& agent) const { return folder_ / "trajectory" / (agent + ".tum"); }
  std::filesystem::path live(const std::string& agent) const { return folder_ / "live" / (agent + ".tum"); }
  // The same of a map that has no known relation to the common one: its coordinates and its unit of length are its own.
  std::filesystem::path trajectory(MapId map, const std::string& agent) const {
    return separate("trajectory", map) / (agent + ".tum");
  }
  std::filesystem::path live(MapId map, const std::string& agent) const {
    return separate("live", map) / (agent + ".tum");
  }
  // Of which the result holds trajectories, beside the common one; ascending.
  std::vector<MapId> separate_maps() const;
  std::filesystem::path tracks(const std::string& agent) const { return folder_ / "tracks" / (agent + ".csv"); }
  std::filesystem::path points() const { return folder_ / "points.csv"; }
  std::filesystem::path dynamic() const { return folder_ / "dynamic.csv"; }
  std::filesystem::path objects() const { return folder_ / "objects.csv"; }
  std::filesystem::path groups() const { return folder_ / "groups.csv"; }
  std::filesystem::path events() const { return folder_ / "events.csv"; }
  std::filesystem::path map() const { return folder_ / "map.ply"; }
  std::filesystem::path report() const { return folder_ / "report.json"; }
  std::filesystem::path evaluation() const { return folder_ / "eval.json"; }
  std::filesystem::path top_view() const { return folder_ / "top_view.png"; }

  // Something of a run is in it, whole or not.
  bool holds_run() const;
  // Removes what a run and its evaluation write; other files stay.
  void remove_run() const;

 private:
  std::filesystem::path separate(const char* what, MapId map) const;
  std::filesystem::path folder_;
};

// static, dynamic, uncertain, false; none for a track without a point.
const char* state_name(std::optional<PointState> state);

struct ResultPoint {
  PointId id;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // map frame
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  PointState state = PointState::kStatic;
  TimeNs first_ns = 0;
  TimeNs last_ns = 0;
  int views = 0;
  std::uint8_t grey = 128;  // in map.ply only
};

struct ResultTrackRow {
  FrameId frame;
  TimeNs t_ns = 0;
  TrackId track;
  Eigen::Vector2d raw_px = Eigen::Vector2d::Zero();
  PointId point;  // 0 = none
  std::optional<PointState> state;
};

struct ResultDynamicRow {
  TimeNs t_ns = 0;
  PointId id;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  int views = 0;
};

struct ResultObjectRow {
  TimeNs t_ns = 0;
  ObjectId object;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // of the middle, map frame
  Eigen::Vector3d velocity_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d extent = Eigen::Vector3d::Zero();  // sides of the box along the axes of the map
  std::vector<PointId> members;
};

struct ResultGroupRow {  // from t_ns on these agents form the group
  TimeNs t_ns = 0;
  GroupId group;
  std::vector<std::string> agents;
};

// Writes rows as they come, in constant memory. A full disk shows in close(), never while running.
class CsvWriter {
 public:
  void close();  // throws UserError when something could not be written

 protected:
  CsvWriter(const std::filesystem::path& file, std::string_view header);
  std::ofstream stream_;

 private:
  std::filesystem::path file_;
};

class PointWriter : public CsvWriter {
 public:
  explicit PointWriter(const std::filesystem::path& file);
  void write(const ResultPoint& point);
};

class TrackWriter : public CsvWriter {
 public:
  explicit TrackWriter(const std::filesystem::path& file);
  void write(const ResultTrackRow& row);
};

class DynamicWriter : public CsvWriter {
 public:
  explicit DynamicWriter(const std::filesystem::path& file);
  void write(const ResultDynamicRow& row);
};

class ObjectWriter : public CsvWriter {
 public:
  explicit ObjectWriter(const std::filesystem::path& file);
  void write(const ResultObjectRow& row);
};

class GroupWriter : public CsvWriter {
 public:
  explicit GroupWriter(const std::filesystem::path& file);
  void write(const ResultGroupRow& row);
};

std::vector<ResultPoint> read_points(const std::filesystem::path& file);
void for_each_track_row(const std::filesystem::path& file, const std::function<void(const ResultTrackRow&)>& row);
void for_each_dynamic_row(const std::filesystem::path& file, const std::function<void(const ResultDynamicRow&)>& row);
void for_each_object_row(const std::filesystem::path& file, const std::function<void(const ResultObjectRow&)>& row);
std::vector<ResultGroupRow> read_groups(const std::filesystem::path& file);

// The static ones of the points as binary PLY: position, grey as red, green, blue, and sqrt_trace_sigma.
void write_ply(const std::filesystem::path& file, const std::vector<ResultPoint>& points);

nlohmann::json read_json(const std::filesystem::path& file);
void write_json(const std::filesystem::path& file, const nlohmann::ordered_json& json);

}  // namespace coslam
