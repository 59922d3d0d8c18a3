// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/stages/group.h"

#include <algorithm>
#include <numeric>

namespace coslam {
namespace {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  bool unite(std::size_t a, std::size_t b) {
    a = find(a);
    b = find(b);
    if (a == b) return false;
    parent_[std::max(a, b)] = std::min(a, b);
    return true;
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace

ViewGraph view_graph(const Map& map, const FrameSet& set) {
  const std::size_t n = map.cameras().size();
  std::vector<bool> here(n, false);
  for (const CameraFrame& cf : set.frames) here[cf.camera.value] = true;
  std::vector<int> shared(n * n, 0);
  for (const CameraFrame& cf : set.frames) {
    for (const auto& [id, track] : map.camera(cf.camera).tracks) {
      const MapPoint* p = map.find(track.point);
      if (p == nullptr) continue;
      for (const BoundTrack& b : p->bound) {
        if (b.camera > cf.camera && here[b.camera.value]) ++shared[cf.camera.value * n + b.camera.value];
      }
    }
  }
  ViewGraph graph;
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n; ++b) {
      if (shared[a * n + b] == 0) continue;
      graph.edges.push_back({map.cameras()[a].id, map.cameras()[b].id, shared[a * n + b]});
    }
  }
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

}  // namespace coslam
