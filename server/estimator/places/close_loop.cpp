// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/close_loop.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "server/estimator/associate/register.h"
#include "server/estimator/pose/localise.h"
#include "server/estimator/solve/pose_graph.h"

namespace coslam {
namespace {

constexpr int kMinShared = 10;      // points, for two cameras of one key frame to hold each other
constexpr double kLoopWeight = 10;  // of an earlier one, in steps of one frame

// The frames of one map as nodes, camera by camera in order of time.
class Nodes {
 public:
  Nodes(const Map& map, MapId map_id) : map_(map), of_frames_(map.cameras().size()) {
    for (const MapCamera& c : map.cameras()) {
      std::vector<int>& of_frames = of_frames_[c.id.value];
      of_frames.assign(c.frames.size(), -1);
      for (std::size_t i = 0; i < c.frames.size(); ++i) {
        if (c.frames[i].map != map_id) continue;
        of_frames[i] = static_cast<int>(keys.size());
        keys.emplace_back(c.id, c.frames[i].set);
      }
    }
  }
  std::optional<int> find(CameraId camera, SetId set) const {
    const MapCamera& c = map_.camera(camera);
    const FramePose* f = c.frame_at(set);
    if (f == nullptr) return std::nullopt;
    const int node = of_frames_[camera.value][static_cast<std::size_t>(f - c.frames.data())];
    return node < 0 ? std::nullopt : std::optional(node);
  }
  std::vector<std::pair<CameraId, SetId>> keys;

 private:
  const Map& map_;
  std::vector<std::vector<int>> of_frames_;  // of each camera; -1: of another map
};

// Points that two nodes share, counted. The first node counts more for the order.
class SharedByNodes {
 public:
  void count(int first, int second) {
    ++n_[static_cast<std::uint64_t>(first) << 32U | static_cast<std::uint32_t>(second)];
  }
  struct Pair {
    int first, second, shared;
  };
  // Ascending.
  std::vector<Pair> pairs() const {
    std::vector<Pair> out;
    out.reserve(n_.size());
    for (const auto& [nodes, n] : n_) out.push_back({static_cast<int>(nodes >> 32U), static_cast<int>(nodes), n});
    std::ranges::sort(out, {}, [](const Pair& p) { return std::pair(p.first, p.second); });
    return out;
  }

 private:
  std::unordered_map<std::uint64_t, int> n_;
};

void add_nodes(const Map& map, const Nodes& nodes, PoseGraph* graph) {
  SetId first = nodes.keys.front().second;
  for (const auto& [camera, set] : nodes.keys) first = std::min(first, set);
  for (const auto& [camera, set] : nodes.keys) {
    graph->nodes.push_back({map.camera(camera).frame_at(set)->cam_from_world, set == first});
  }
}

// Drift grows from set to set while a camera is followed. Across a time in which nobody heard of it, as when the server
// was away, its pose is what it says itself and its points are new ones: that may hide more drift than all the rest.
double step_weight(const Map& map, const CameraFrames& camera, SetId before, SetId now) {
  constexpr double kFollowed_s = LocaliseConfig().lost_after_s;
  const std::uint32_t sets = now.value - before.value;
  const bool given_out = before < camera.past.until;  // frames in between
  const double drift = given_out || sets <= map.sets_in(kFollowed_s) ? 1.0 : sets;
  return 1.0 / (drift * sets);
}

void link_successive_frames(const Map& map, const Nodes& nodes, PoseGraph* graph) {
  for (std::size_t i = 1; i < nodes.keys.size(); ++i) {
    const auto& [camera, set] = nodes.keys[i];
    const auto& [camera_before, set_before] = nodes.keys[i - 1];
    if (camera != camera_before) continue;
    graph->links.push_back(
        {static_cast<int>(i - 1), static_cast<int>(i), step_weight(map, map.camera(camera), set_before, set)});
  }
}

// Cameras that saw the same points at a key frame.
void link_neighbours(const Map& map, MapId map_id, const Nodes& nodes, PoseGraph* graph) {
  SharedByNodes shared;
  std::vector<int> together;  // of one set
  for (const auto& [id, p] : map.points()) {
    if (p.map != map_id) continue;
    SetId set;
    for (const KeyObservation& o : p.key_observations) {
      if (o.set != set) together.clear();
      set = o.set;
      const auto node = nodes.find(o.camera, o.set);
      if (!node || (!together.empty() && together.back() == *node)) continue;
      for (const int before : together) shared.count(before, *node);
      together.push_back(*node);
    }
    together.clear();
  }
  std::vector<SharedByNodes::Pair> pairs = shared.pairs();
  std::ranges::stable_sort(pairs, {},
                           [&](const auto& p) { return nodes.keys[static_cast<std::size_t>(p.first)].second; });
  for (const auto& [first, second, n] : pairs) {
    if (n >= kMinShared) graph->links.push_back({first, second, 1.0});
  }
}

// Who comes back to a place and finds its points again is held to those who were there before: each frame to the one of
// the visit before that shares most points with it. Without that a loop closed elsewhere would tear the two apart.
void link_visits(const Map& map, MapId map_id, const Nodes& nodes, PoseGraph* graph) {
  const std::uint32_t gap = map.sets_in(map.config().recent_s);
  SharedByNodes shared;  // node, node of the visit before
  for (const auto& [id, p] : map.points()) {
    if (p.map != map_id || p.key_observations.empty()) continue;
    const auto& seen = p.key_observations;
    if (seen.back().set.value - seen.front().set.value <= gap) continue;
    std::vector<int> before, now;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (i > 0 && seen[i].set.value - seen[i - 1].set.value > gap) before = std::exchange(now, {});
      const auto node = nodes.find(seen[i].camera, seen[i].set);
      if (!node) continue;
      for (const int b : before) shared.count(*node, b);
      now.push_back(*node);
    }
  }
  const std::vector<SharedByNodes::Pair> pairs = shared.pairs();
  for (auto at = pairs.begin(); at != pairs.end();) {
    const auto end = std::find_if(at, pairs.end(), [&](const auto& p) { return p.first != at->first; });
    const auto most = std::max_element(at, end, [](const auto& a, const auto& b) { return a.shared < b.shared; });
    if (most->shared >= kMinShared) graph->links.push_back({most->second, most->first, 1.0});
    at = end;
  }
}

void link_loops(const std::vector<LoopConstraint>& earlier, const Nodes& nodes, PoseGraph* graph) {
  for (const LoopConstraint& r : earlier) {
    const auto a = nodes.find(r.camera, r.set), b = nodes.find(r.to_camera, r.to_set);
    if (a && b) graph->links.push_back({*a, *b, kLoopWeight});
  }
}

bool tie(const Nodes& nodes, const LoopConstraint& loop, const std::vector<CameraId>& together, PoseGraph* graph) {
  const auto node = nodes.find(loop.camera, loop.set), to_node = nodes.find(loop.to_camera, loop.to_set);
  if (!node || !to_node || graph->nodes[static_cast<std::size_t>(*node)].fixed) return false;
  graph->ties.push_back({*node, *to_node, loop.camera_from_to, loop.scale});
  const Rigid3& pose = graph->nodes[static_cast<std::size_t>(*node)].cam_from_world;
  for (const CameraId c : together) {
    const auto member = nodes.find(c, loop.set);
    if (!member || c == loop.camera || *member == *to_node || graph->nodes[static_cast<std::size_t>(*member)].fixed)
      continue;
    graph->ties.push_back(
        {*member, *node, graph->nodes[static_cast<std::size_t>(*member)].cam_from_world * pose.inverse(), 1});
  }
  return true;
}

// A point goes with the frame that saw it last.
std::optional<int> frame_of(const Map& map, const Nodes& nodes, const MapPoint& p) {
  for (std::size_t i = p.key_observations.size(); i-- > 0;) {
    if (const auto node = nodes.find(p.key_observations[i].camera, p.key_observations[i].set)) return node;
  }
  for (const BoundTrack& b : p.bound) {
    if (const auto node = nodes.find(b.camera, map.camera(b.camera).frames.back().set)) return node;
  }
  return std::nullopt;
}

void apply(PlaceRecognitionEdit& edit, MapId map_id, const Nodes& nodes, const PoseGraphSolution& solution) {
  const Map& map = edit.map();
  std::map<CameraId, Similarity3> last;
  for (std::size_t i = 0; i < nodes.keys.size(); ++i) {
    const auto& [camera, set] = nodes.keys[i];
    const MapCamera& c = map.camera(camera);
    edit.adjust_pose(c, *c.frame_at(set), solution.nodes[i].cam_from_world);
    last[camera] = solution.nodes[i].new_from_old;
  }
  for (const auto& [camera, new_from_old] : last) {
    if (map.camera(camera).map == map_id) edit.carry_agent(map.camera(camera), new_from_old);
  }
  for (const auto& [id, p] : map.points()) {
    if (p.map != map_id) continue;
    if (const auto node = frame_of(map, nodes, p)) {
      edit.transform_point(p, solution.nodes[static_cast<std::size_t>(*node)].new_from_old);
      // What moves is where its cameras saw it last, not where old views would have it; what is out of sight can wait
      // for the adjustment that follows, which triangulates anew what it reaches.
      if (p.rests() && map.is_recent(p.last_seen)) retriangulate(edit, p);
    }
  }
  edit.raise_epoch();
}

}  // namespace

bool close_loop(PlaceRecognitionEdit& edit, MapId map_id, const LoopConstraint& loop,
                const std::vector<LoopConstraint>& earlier, const std::vector<CameraId>& together) {
  const Map& map = edit.map();
  const Nodes nodes(map, map_id);
  PoseGraph graph;
  if (nodes.keys.empty()) return false;
  add_nodes(map, nodes, &graph);
  if (!tie(nodes, loop, together, &graph)) return false;
  link_successive_frames(map, nodes, &graph);
  link_neighbours(map, map_id, nodes, &graph);
  link_visits(map, map_id, nodes, &graph);
  link_loops(earlier, nodes, &graph);
  const PoseGraphSolution solution = solve_path_graph(graph);
  if (!solution.ok) return false;
  apply(edit, map_id, nodes, solution);
  edit.note_moved(map_id, Why::kLoopClosed, {loop.scale, 0});
  return true;
}

}  // namespace coslam
