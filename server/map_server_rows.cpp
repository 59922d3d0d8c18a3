// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// How a map outlives its server.
#include <algorithm>

#include "server/map/serialise.h"
#include "server/map_server.h"

namespace coslam {

std::vector<Row> MapServer::changed_rows() {
  std::vector<Row> rows = rows_.changes(map());
  pipeline_.stage<Meetings>().save(&rows);
  pipeline_.stage<Scale>().save(&rows);
  rows.push_back({"state", static_cast<std::int64_t>(StateRow::kObjects),
                  octets_of(pipeline_.stage<ObjectFinder>().next_object())});
  return rows;
}

void MapServer::restore(const Tables& tables, double gap_s) {
  constexpr double kLongest_s = 60;  // later nothing is recent any more
  edit_.restore(tables);
  pipeline_.stage<Meetings>().restore(tables);
  pipeline_.stage<Scale>().restore(tables);
  std::uint32_t next_object = 1;
  read_state(tables, StateRow::kObjects, next_object);
  pipeline_.stage<ObjectFinder>().number_from(next_object);
  restored_until_ = map().now();
  restored_cameras_ = map().cameras().size();
  changed_rows();  // what is in the file need not be written again, and what goes from now on is to go there, too
  edit_.pass_sets(map().sets_in(std::clamp(gap_s, 0.0, kLongest_s)));
}

void MapServer::meet_all() {
  for (const MapCamera& c : map().cameras()) met_since_[c.id] = SetId();
}

std::optional<SetId> MapServer::met_since(CameraId camera) const {
  const bool restored = restored_until_ && camera.value < restored_cameras_;
  if (!restored) return SetId();
  const auto met = met_since_.find(camera);
  return met == met_since_.end() ? std::nullopt : std::optional(met->second);
}

}  // namespace coslam
