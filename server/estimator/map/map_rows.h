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

// Converts the map to rows: one for each camera, frame, point and path of a moving point, and one for the rest.
// Remembers what was written, so that only changes are written again. Thread-compatible.
class MapRows {
 public:
  // Returns all that changed since the last call; these rows belong together.
  std::vector<Row> changes(const Map& map);
  // Fills an empty map from rows of that version; no camera is alive in it. Throws UserError for rows that contradict
  // each other.
  static void restore(const Tables& tables, int version, Map* map);
  // Has changes() return everything once more, as needed when the file has it in an older version.
  void write_all_again();

 private:
  using Known = std::unordered_map<PointId, std::uint64_t>;
  static void restore_cameras_apart(const Tables& tables, Map* map);
  void frames(const Map& map, std::vector<Row>* rows);
  template <class Value>
  static void keep(const char* table, const std::map<PointId, Value>& values, Known* known, std::vector<Row>* rows);

  // Fingerprints of what was written.
  std::vector<std::vector<std::pair<SetId, std::uint64_t>>> frames_;  // one vector per camera, sorted by set
  Known points_, motions_;
};

}  // namespace coslam
