// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// How a map outlives its server.
#include <algorithm>

#include "server/estimator/map/serialise.h"
#include "server/estimator/map_server.h"

namespace coslam {

std::vector<Row> MapServer::changed_rows() {
  std::vector<Row> rows = rows_.changes(map());
  pipeline_.save(&rows);
  rows.push_back({"state", static_cast<std::int64_t>(StateRow::kAdjusted), octets_of(adjusted_)});
  rows.push_back({"state", static_cast<std::int64_t>(StateRow::kRun), octets_of(run_.id)});
  return rows;
}

void MapServer::restore(const Tables& tables, double gap_s, int version) {
  constexpr double kLongest_s = 60;  // later nothing is recent any more
  edit_.restore(tables, version);
  pipeline_.restore(tables);
  read_state(tables, StateRow::kAdjusted, adjusted_);
  RunId before;  // none in a file of before it was kept
  read_state(tables, StateRow::kRun, before);
  if (before != RunId()) run_.continues = {before, map().epoch()};
  moves_seen_ = map().moves().size();
  first_new_map_ = map().next_map();
  restored_until_ = map().now();
  restored_cameras_ = map().cameras().size();
  changed_rows();  // what is in the file need not be written again, and what goes from now on is to go there, too
  if (version < kRowsVersion) rows_.write_all_again();
  edit_.pass_sets(map().sets_in(std::clamp(gap_s, 0.0, kLongest_s)));
}

MapServer::TakenIn MapServer::take_in(const MapServer& other) {
  TakenIn out;
  const MapId first = map().next_map();
  out.as = edit_.take_in(other.map());
  pipeline_.take_in(other.pipeline_, out.as);
  out.joined = join_maps(edit_, pipeline_.stage<MapRole::KnowsPlaces>().places(), first);
  for (const JoinedMaps& j : out.joined) adjusted_.erase(j.remaining);
  return out;
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
