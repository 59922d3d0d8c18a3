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
  std::vector<CameraId> group_with(CameraId camera) const;  // all of its group; itself alone when it is in none
};

// Cameras by shared view at this instant (paper 6.1).
ViewGraph view_graph(const Map& map, const FrameSet& set);

struct GroupingConfig {
  int min_shared = 12;       // points that bring two cameras together
  double min_overlap = 0.1;  // of both views, by the map, that keeps them so without any
  int keep_shared = 4;     // points that keep them so, and that bring them together if their views overlap so far; and
  int least_shared = 2;    // at least, where they overlap more: the fewer the farther they do
  double confirm_s = 0.2;  // that a pair must say so before it is, or is not any more, together
  double settle_s = 0.3;   // that a new grouping must last: cameras seldom part in one instant
  double hold_s = 1.0;     // every grouping stays at least so long
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

// Groups with hysteresis: a count of points flickers, a group of cameras must not. Where the map says that two views
// overlap, few points found in both confirm it, and a lack of them does not deny it: how many are found depends on how
// far apart the two cameras stand, a group on what they see. Counted are the newest frames of both, be they of one set
// or not: cameras of other rates are seldom in one, and frames get lost.
class Grouping {
 public:
  static constexpr std::string_view kName = "grouping";
  using Config = GroupingConfig;
  explicit Grouping(const GroupingConfig& of) : config(of) {}
  GroupingConfig config;

  // The view graph of this set, its groups those that hold.
  ViewGraph run(const Map& map, const FrameSet& set);

 private:
  struct Pair {
    bool joined = false;
    TimeNs since_ns = 0;  // the first instant of those that say otherwise
    bool doubted = false;
  };
  void judge(const Map& map, const FrameSet& set, const std::vector<ViewEdge>& edges);
  bool see_the_same(bool joined, int shared, CameraId first, CameraId second, ViewOverlap& overlap) const;
  std::vector<std::vector<CameraId>> components(const Map& map, TimeNs now_ns) const;

  std::map<std::pair<CameraId, CameraId>, Pair> pairs_;
  std::vector<std::vector<CameraId>> groups_;
  std::optional<TimeNs> changed_ns_;
  std::vector<std::vector<CameraId>> next_;  // what they are about to become
  TimeNs next_since_ns_ = 0;
};

}  // namespace coslam
