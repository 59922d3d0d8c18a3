// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "server/estimator/map/map.h"
#include "server/estimator/map/rows.h"

namespace coslam {

// The map as rows: one for each camera, frame, point and path of a moving point, and one for the rest. Remembers what
// was given out, so that only what changed since is given out again. Thread-compatible.
class MapRows {
 public:
  // All that changed since the last call; they belong together.
  std::vector<Row> changes(const Map& map);
  // Of a map without anything in it. No camera is alive in it. Throws UserError for rows that contradict each other.
  // version: of the rows.
  static void restore(const Tables& tables, int version, Map* map);
  // All that was given out is as if it had changed, as where the file has it in an older version.
  void write_all_again();

 private:
  using Known = std::unordered_map<PointId, std::uint64_t>;
  static void restore_cameras_apart(const Tables& tables, Map* map);
  void frames(const Map& map, std::vector<Row>* rows);
  template <class Value>
  static void keep(const char* table, const std::map<PointId, Value>& values, Known* known, std::vector<Row>* rows);

  // Fingerprints.
  std::vector<std::vector<std::pair<SetId, std::uint64_t>>> frames_;  // by camera, ascending
  Known points_, motions_;
};

}  // namespace coslam
