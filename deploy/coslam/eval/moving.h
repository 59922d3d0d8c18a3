// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/dataset/result.h"
#include "common/geometry/rigid3.h"

// Scores how well moving things are told from static ones, and followed.
namespace coslam::eval {

// Masks of moving things: <folder>/<agent>/<6-digit frame>.png, non-zero = moving. Keeps the one read last.
class Masks {
 public:
  explicit Masks(std::filesystem::path folder) : folder_(std::move(folder)) {}
  // Whether a pixel shows a moving thing; empty without a mask for the frame and within two pixels of an outline, where
  // a corner belongs to either side.
  std::optional<bool> moving_at(const std::string& agent, FrameId frame, const Eigen::Vector2d& raw_px);

 private:
  std::filesystem::path folder_;
  std::filesystem::path file_;
  cv::Mat mask_;
};

// Counts observations. Positive = dynamic; a track that is said nothing of is not dynamic.
class Classification {
 public:
  void add(bool moving, std::optional<PointState> state);
  int observations() const { return dynamic_moving_ + dynamic_still_ + other_moving_ + other_still_; }
  std::optional<double> precision() const;         // share of moving things in the observations called dynamic
  std::optional<double> recall() const;            // share called dynamic of the observations of moving things
  std::optional<double> static_on_moving() const;  // share called static of the observations of moving things
  std::optional<double> false_alarm() const;       // share called dynamic of the observations of still things

 private:
  int dynamic_moving_ = 0, dynamic_still_ = 0, other_moving_ = 0, other_still_ = 0, static_moving_ = 0;
};

// Ages of the tracks of one agent, from the rows of its file.
class TrackAges {
 public:
  // Age in frames, since the track's first row; the rows of a track come in order.
  std::uint32_t age(const ResultTrackRow& row) {
    return row.frame.value - first_.try_emplace(row.track, row.frame).first->second.value;
  }

 private:
  std::unordered_map<TrackId, FrameId> first_;
};

struct StampedPosition {
  TimeNs t_ns = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};
using PointPath = std::vector<StampedPosition>;  // ascending time

// The position at t_ns, linear between two samples at most max_gap_ns apart; empty outside.
std::optional<Eigen::Vector3d> position_at(const PointPath& path, TimeNs t_ns, TimeNs max_gap_ns);

// Seconds from the first to the last sample, in the median of the paths with two or more.
std::optional<double> median_length_s(const std::unordered_map<PointId, PointPath>& paths);

std::unordered_map<PointId, PointPath> read_dynamic(const std::filesystem::path& file);
// `t_s,id,x,y,z`; throws UserError with file and line.
std::map<std::string, PointPath> read_truth_points(const std::filesystem::path& file, TimeNs later_ns = 0);

// Distances of the estimated paths to the marked points that they follow: each path goes with the marked point that is
// nearest in the median; one farther than max_distance_m from all of them follows something that is not marked.
struct DynamicErrors {
  std::vector<double> errors_m;
  int paths = 0;
  int unmatched_paths = 0;
};
DynamicErrors dynamic_errors(const std::unordered_map<PointId, PointPath>& estimate,
                             const std::map<std::string, PointPath>& truth, const Similarity3& truth_from_map,
                             double max_distance_m = 0.3);

}  // namespace coslam::eval
