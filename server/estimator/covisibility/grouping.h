// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "server/estimator/covisibility/overlap.h"
#include "server/estimator/map/map.h"

namespace coslam {

struct ViewEdge {
  CameraId first, second;
  int shared = 0;  // N_ij: map points that both observe now
};

struct ViewGraph {
  std::vector<ViewEdge> edges;                              // N_ij > 0
  std::vector<ViewEdge> tree;                               // maximum-weight spanning forest
  std::vector<std::vector<CameraId>> groups;                // connected components, ascending
  int group_of(CameraId camera) const;                      // index in groups, -1 = in none
  std::vector<CameraId> group_with(CameraId camera) const;  // all members of its group, or the camera alone
};

// Computes the view graph (covisibility graph) of the cameras at this instant (paper 6.1).
ViewGraph view_graph(const Map& map, const FrameSet& set);

struct GroupingConfig {
  int min_shared = 12;       // points that bring two cameras together
  double min_overlap = 0.1;  // overlap of both views, by the map, that keeps two cameras together without shared points
  int keep_shared = 4;       // points that keep two cameras together, and bring together two whose views overlap
  int least_shared = 2;  // least points that bring two cameras together; more overlap needs fewer points, down to this
  double confirm_s = 0.2;  // time for which the points must say otherwise before a pair joins or parts
  double settle_s = 0.3;   // time that a new grouping must last: cameras seldom part in one instant
  double hold_s = 1.0;     // time that every grouping stays at least
};

template <class V>
void describe(V& v, GroupingConfig& c) {
  v.field("min_shared", c.min_shared, {1, 1000}, "points that bring two cameras into one group");
  v.field("keep_shared", c.keep_shared, {0, 1000},
          "points that keep them in it, and that bring them together where their views overlap");
  v.field("min_overlap", c.min_overlap, {0, 1}, "of both views, by the map, that keeps them in it without any");
  v.field("confirm_s", c.confirm_s, {0, 10}, "for so long before they join, and with fewer before they part");
  v.field("hold_s", c.hold_s, {0, 60}, "that every grouping stays at least");
}

// Groups cameras with hysteresis: the number of shared points flickers, but a group must not. Where the map says that
// two views overlap, few points found in both confirm it, and a lack of them does not deny it: how many are found
// depends on how far apart the two cameras stand, a group on what they see. Counts the newest frames of both cameras,
// in one set or not: cameras of other rates are seldom in one, and frames get lost.
class Grouping {
 public:
  static constexpr std::string_view kName = "grouping";
  using Config = GroupingConfig;
  explicit Grouping(const GroupingConfig& stage_config) : config(stage_config) {}
  GroupingConfig config;

  // Returns the view graph of this set, with the groups of the hysteresis.
  ViewGraph run(const Map& map, const FrameSet& set);

 private:
  struct Pair {
    bool joined = false;
    TimeNs since_ns = 0;  // first instant at which the points said otherwise
    bool doubted = false;
  };
  void judge(const Map& map, const FrameSet& set, const std::vector<ViewEdge>& edges);
  bool see_the_same(bool joined, int shared, CameraId first, CameraId second, ViewOverlap& overlap) const;
  std::vector<std::vector<CameraId>> components(const Map& map, TimeNs now_ns) const;

  std::map<std::pair<CameraId, CameraId>, Pair> pairs_;
  std::vector<std::vector<CameraId>> groups_;
  std::optional<TimeNs> changed_ns_;
  std::vector<std::vector<CameraId>> next_;  // groups by the pairs as they are now; they become groups_ when they last
  TimeNs next_since_ns_ = 0;
};

}  // namespace coslam
