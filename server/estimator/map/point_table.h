// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "common/base/flat_map.h"
#include "common/base/id_table.h"
#include "server/estimator/map/point.h"

namespace coslam {

// Table of all points of the map, with indices for frequent queries. A copy refers to its own points.
struct PointTable {
  std::map<PointId, MapPoint> all;
  IdTable<PointId, MapPoint> by_id;
  std::map<PointId, MapPoint*> moving;
  FlatMap<PointId, MapPoint*> recent;  // points seen lately, and some that were seen longer ago

  PointTable() = default;
  PointTable(const PointTable& other) : all(other.all) {
    for (auto& [id, p] : all) index(p, other.recent.contains(id));
  }
  PointTable& operator=(const PointTable& other) {
    if (this != &other) *this = PointTable(other);
    return *this;
  }
  PointTable(PointTable&&) = default;
  PointTable& operator=(PointTable&&) = default;
  ~PointTable() = default;

  // Adds a point of `all` to the indices.
  void index(MapPoint& point, bool is_recent) {
    by_id.put(point.id, point);
    if (point.moves()) moving.emplace(point.id, &point);
    if (is_recent) recent.emplace(point.id, &point);
  }
  void erase(PointId id) {
    moving.erase(id);
    recent.erase(id);
    by_id.erase(id);
    all.erase(id);
  }
};

}  // namespace coslam
