// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/dataset/result.h"
#include "common/geometry/rigid3.h"
#include "deploy/coslam/eval/moving.h"
#include "deploy/coslam/eval/points.h"

// Whether the bodies that move in a simulated scene are found, and followed as one thing.
namespace coslam::eval {

struct BodyScore {
  int instants = 0;                         // at which two cameras track it while it moves
  int covered = 0;                          // instants with a moving point on it
  int object_instants = 0;                  // at which two cameras have many tracks on it
  int objects_found = 0;                    // object_instants with exactly one object that is mostly on it
  std::vector<double> velocity_errors_m_s;  // errors of these objects

  std::optional<double> coverage() const;
  std::optional<double> object_found() const;
  std::optional<double> velocity_error_m_s() const;  // median
  BodyScore& operator+=(const BodyScore& other);
};

// Sum of the scores of several bodies.
BodyScore sum_of(const std::map<std::string, BodyScore>& bodies);

using ObjectsAt = std::map<TimeNs, std::vector<ResultObjectRow>>;
ObjectsAt read_objects(const std::filesystem::path& file);

// Collects which bodies the tracks were on, then compares them with paths and objects.
class BodyTracks {
 public:
  void add(const std::string& agent, const ResultTrackRow& row, const SurfacePoint& seen);
  // Scores by name of the body; without objects there are no scores of them. frame_ns: interval between frames; times
  // that close are the same instant.
  std::map<std::string, BodyScore> scores(const std::unordered_map<PointId, PointPath>& dynamic,
                                          const std::optional<ObjectsAt>& objects, const Similarity3& truth_from_map,
                                          TimeNs frame_ns) const;

 private:
  struct Instant {
    std::map<std::string, int> tracks;                       // number of tracks on moving surfaces, by agent
    Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();  // velocity of the body
  };
  std::unordered_map<PointId, std::string> bodies_of_points() const;

  std::map<std::string, std::map<TimeNs, Instant>> bodies_;
  std::unordered_map<PointId, std::map<std::string, int>> seen_on_;  // no name: what cannot move
};

}  // namespace coslam::eval
