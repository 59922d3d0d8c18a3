// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "server/estimator/covisibility/grouping.h"
#include "server/estimator/map/journal.h"
#include "server/estimator/map/map.h"
#include "server/show/publish/snapshot.h"

namespace coslam {

// Sentence about an agent whose images were taken so much later than they are dated.
std::string misdated_sentence(const std::string& agent, const std::string& against, double lag_s);

// Describes the events of cameras, groups and maps in sentences: few enough to be published one by one. Events of
// points and tracks are only in the journal.
class EventFeed {
 public:
  // Events of a frame set.
  std::vector<PublicEvent> after_set(const Map& map, const Journal& journal, const ViewGraph& graph);
  // Arrivals and departures; may be called at any time.
  std::vector<PublicEvent> comings(const Map& map);

  // Why a camera has no pose; empty when it has one.
  std::string why_lost(const MapCamera& camera) const;

 private:
  struct Known {
    RunId run;
    bool alive = false;
  };
  void of_camera(const Map& map, const Event& event, std::vector<PublicEvent>* out);
  static void of_map(const Map& map, const Event& event, std::vector<PublicEvent>* out);
  void of_groups(const Map& map, const ViewGraph& graph, std::vector<PublicEvent>* out);

  std::map<CameraId, Known> known_;
  std::map<CameraId, std::string> lost_;       // why
  std::vector<std::vector<CameraId>> groups_;  // groups of the set before
};

}  // namespace coslam
