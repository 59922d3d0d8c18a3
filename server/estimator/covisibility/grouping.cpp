// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/covisibility/grouping.h"

#include <algorithm>
#include <limits>

#include "server/estimator/covisibility/disjoint_sets.h"

namespace coslam {
int ViewGraph::group_of(CameraId camera) const {
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (std::find(groups[g].begin(), groups[g].end(), camera) != groups[g].end()) return static_cast<int>(g);
  }
  return -1;
}

std::vector<CameraId> ViewGraph::group_with(CameraId camera) const {
  const int group = group_of(camera);
  return group < 0 ? std::vector{camera} : groups[static_cast<std::size_t>(group)];
}

namespace {

// Pairs of these cameras that follow common points.
std::vector<ViewEdge> edges_between(const Map& map, const std::vector<bool>& cameras) {
  const std::size_t n = map.cameras().size();
  std::vector<int> shared(n * n, 0);
  for (const MapCamera& c : map.cameras()) {
    if (!cameras[c.id.value]) continue;
    for (const auto& [id, track] : c.tracks) {
      const MapPoint* p = map.find(track.point);
      if (p == nullptr) continue;
      for (const BoundTrack& b : p->bound) {
        if (b.camera > c.id && cameras[b.camera.value]) ++shared[c.id.value * n + b.camera.value];
      }
    }
  }
  std::vector<ViewEdge> edges;
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n; ++b) {
      if (shared[a * n + b] > 0) edges.push_back({map.cameras()[a].id, map.cameras()[b].id, shared[a * n + b]});
    }
  }
  return edges;
}

std::vector<bool> in_set(const Map& map, const FrameSet& set) {
  std::vector<bool> present(map.cameras().size(), false);
  for (const CameraFrame& cf : set.frames) present[cf.camera.value] = true;
  return present;
}

}  // namespace

ViewGraph view_graph(const Map& map, const FrameSet& set) {
  const std::size_t n = map.cameras().size();
  ViewGraph graph;
  graph.edges = edges_between(map, in_set(map, set));
  std::vector<ViewEdge> by_weight = graph.edges;
  std::stable_sort(by_weight.begin(), by_weight.end(),
                   [](const auto& x, const auto& y) { return x.shared > y.shared; });
  DisjointSets sets(n);
  for (const ViewEdge& e : by_weight) {
    if (sets.unite(e.first.value, e.second.value)) graph.tree.push_back(e);
  }
  std::vector<std::vector<CameraId>> by_root(n);
  for (const CameraFrame& cf : set.frames) {
    if (map.camera(cf.camera).map != MapId()) by_root[sets.find(cf.camera.value)].push_back(cf.camera);
  }
  for (auto& group : by_root) {
    if (!group.empty()) graph.groups.push_back(std::move(group));
  }
  return graph;
}

bool Grouping::see_the_same(bool joined, int shared, CameraId first, CameraId second, ViewOverlap& overlap) const {
  if (shared >= (joined ? config.keep_shared : config.min_shared)) return true;
  if (!joined && shared < config.least_shared) return false;
  const double share = overlap.between(first, second).least();
  if (share < config.min_overlap) return false;
  return joined || shared * share >= config.keep_shared * config.min_overlap;
}

void Grouping::judge(const Map& map, const FrameSet& set, const std::vector<ViewEdge>& edges) {
  const TimeNs now_ns = set.t_ns;
  const std::vector<bool> present = in_set(map, set);
  std::vector<bool> lately = present;
  const auto unseen_s = [&](const MapCamera& c) {
    return c.frames.empty() ? std::numeric_limits<double>::infinity() : to_seconds(now_ns - c.frames.back().capture_ns);
  };
  for (const MapCamera& c : map.cameras()) lately[c.id.value] = lately[c.id.value] || unseen_s(c) <= kOneTime_s;
  std::map<std::pair<CameraId, CameraId>, int> shared;
  for (const ViewEdge& e : lately == present ? edges : edges_between(map, lately))
    shared[{e.first, e.second}] = e.shared;
  for (const auto& [pair, n] : shared) pairs_.try_emplace(pair);
  ViewOverlap overlap(map);
  for (auto& [pair, state] : pairs_) {
    // What is not seen now says nothing for a while.
    const auto& [first, second] = pair;
    if (std::max(unseen_s(map.camera(first)), unseen_s(map.camera(second))) > config.hold_s) state = {};
    if (!lately[first.value] || !lately[second.value]) continue;
    const auto at = shared.find(pair);
    const int n = at == shared.end() ? 0 : at->second;
    const bool same_map = map.camera(pair.first).map == map.camera(pair.second).map;
    const bool says = same_map && see_the_same(state.joined, n, pair.first, pair.second, overlap);
    if (says == state.joined) {
      state.doubted = false;
      continue;
    }
    if (!state.doubted) state.since_ns = now_ns;
    state.doubted = true;
    if (to_seconds(now_ns - state.since_ns) < config.confirm_s) continue;
    state = {says, now_ns, false};
  }
}

// Of the cameras that have a map, also those whose frame is missing now.
std::vector<std::vector<CameraId>> Grouping::components(const Map& map, TimeNs now_ns) const {
  DisjointSets sets(map.cameras().size());
  for (const auto& [pair, state] : pairs_) {
    if (state.joined) sets.unite(pair.first.value, pair.second.value);
  }
  std::map<std::size_t, std::vector<CameraId>> by_root;
  for (const MapCamera& c : map.cameras()) {
    const bool present = !c.frames.empty() && to_seconds(now_ns - c.frames.back().capture_ns) < config.hold_s;
    if (present && c.map != MapId()) by_root[sets.find(c.id.value)].push_back(c.id);
  }
  std::vector<std::vector<CameraId>> out;
  out.reserve(by_root.size());
  for (auto& [root, group] : by_root) out.push_back(std::move(group));
  return out;
}

ViewGraph Grouping::run(const Map& map, const FrameSet& set) {
  ViewGraph graph = view_graph(map, set);
  judge(map, set, graph.edges);
  auto now = components(map, set.t_ns);
  if (now != next_) {
    next_ = std::move(now);
    next_since_ns_ = set.t_ns;
  }
  const bool settled = groups_.empty() || to_seconds(set.t_ns - next_since_ns_) >= config.settle_s;
  const bool held = !changed_ns_ || to_seconds(set.t_ns - *changed_ns_) >= config.hold_s;
  if (next_ != groups_ && settled && held) {
    // The very first ones only come to be.
    if (!groups_.empty()) changed_ns_ = set.t_ns;
    groups_ = next_;
  }
  graph.groups = groups_;
  return graph;
}

}  // namespace coslam
