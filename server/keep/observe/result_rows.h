// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <limits>
#include <map>
#include <vector>

#include "common/dataset/result.h"
#include "server/estimator/map/map.h"
#include "server/estimator/motion/moving_path.h"
#include "server/keep/observe/result_past.h"

// Rows of a result's files as the map has them in the end.
namespace coslam {

// Points of one map.
std::vector<ResultPoint> result_points(const Map& map, MapId map_id);

// Places of moving points in one map, by the poses that cameras have now; ascending time.
std::vector<ResultDynamicRow> moving_rows(const Map& map, MapId map_id);

// Writes where the members of objects were by the final poses, and how fast by their paths before and after the
// instant: without the lag of what was known at the time. Rows and objects come in the order of time.
class ObjectRows {
 public:
  explicit ObjectRows(ObjectWriter* writer) : writer_(*writer) {}

  void add(const ResultDynamicRow& row);
  void add(const std::vector<SeenObject>& objects);
  TimeNs known_until_ns() const { return known_until_ns_; }  // time of the newest object
  // Writes the rest: no more rows come.
  void finish();

 private:
  void write_until(TimeNs t_ns);
  void write(const SeenObject& o);

  ObjectWriter& writer_;
  std::map<PointId, MovingPath> paths_;  // newest part of each path
  std::deque<SeenObject> waiting_;       // objects that wait for what comes after them
  static constexpr TimeNs kLongAgo_ns = std::numeric_limits<TimeNs>::min() / 2;
  TimeNs newest_ns_ = kLongAgo_ns, thinned_ns_ = kLongAgo_ns, known_until_ns_ = kLongAgo_ns;
};

}  // namespace coslam
