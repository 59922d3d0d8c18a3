// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/dataset/file.h"
#include "common/dataset/result_folder.h"
#include "common/model/map_patch.h"

// The files of a RESULT folder, see docs/configuration.md. Readers throw UserError with file and line.
namespace coslam {

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
  std::array<std::uint8_t, 3> rgb{128, 128, 128};  // in map.ply only
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
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // centre, map frame
  Eigen::Vector3d velocity_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d extent = Eigen::Vector3d::Zero();  // sides of the box along the axes of the map
  std::vector<PointId> members;
};

struct ResultGroupRow {  // the group that these agents form from t_ns on
  TimeNs t_ns = 0;
  GroupId group;
  std::vector<std::string> agents;
};

// Writes rows as they come, in constant memory. write() never throws, see OutputFile for what could not be written.
class CsvWriter {
 public:
  std::optional<std::string> take_problem() { return file_.take_problem(); }
  bool ended() const { return file_.ended(); }
  void check() { file_.check(); }  // throws UserError when something could not be written so far
  void close() { file_.close(); }  // throws like check()

 protected:
  CsvWriter(const std::filesystem::path& file, std::string_view header, OutputFile::Shows shows);
  OutputFile file_;
  std::string line_;  // one buffer for all rows: there are many
};

// Those of points, paths and objects show when they are closed, those of tracks and groups at once.

class PointWriter : public CsvWriter {
 public:
  explicit PointWriter(const std::filesystem::path& file);
  void write(const ResultPoint& point);
};

class TrackWriter : public CsvWriter {
 public:
  explicit TrackWriter(const std::filesystem::path& file, OutputFile::Shows shows = OutputFile::Shows::kAtOnce);
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

// The static ones of the points as binary PLY: position, red, green, blue, and sqrt_trace_sigma.
void write_ply(const std::filesystem::path& file, const std::vector<ResultPoint>& points, LengthUnit unit);

nlohmann::json read_json(const std::filesystem::path& file);
void write_json(const std::filesystem::path& file, const nlohmann::ordered_json& json);

}  // namespace coslam
