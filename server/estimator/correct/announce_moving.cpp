// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/correct/announce_moving.h"

#include <algorithm>

#include "common/model/map_patch.h"

namespace coslam {
namespace {

std::uint8_t cameras_now(const Map& map, const MapPoint& point) {
  std::set<CameraId> cameras;
  for (const BoundTrack& b : point.bound) {
    const MapCamera& c = map.camera(b.camera);
    if (c.frames.back().set == map.now() && c.frames.back().map == point.map) cameras.insert(b.camera);
  }
  return static_cast<std::uint8_t>(std::min<std::size_t>(cameras.size(), 255));
}

// The best `most` items stay, in order.
template <class Items, class Better>
void keep_best(Items& items, std::size_t most, Better better, std::uint32_t* left_out) {
  std::stable_sort(items.begin(), items.end(), better);
  if (items.size() <= most) return;
  *left_out += static_cast<std::uint32_t>(items.size() - most);
  items.resize(most);
}

float spread(const MovingPointState& p) { return p.covariance[0] + p.covariance[3] + p.covariance[5]; }

}  // namespace

std::vector<MovingState> MovingWriter::write(const Map& map, const std::vector<MovingObject>& objects,
                                             const std::set<MapId>& in_metres) {
  std::map<MapId, MovingState> states;
  for (const MapId id : moving_maps_) states[id];
  std::map<PointId, ObjectId> object_of;
  for (const MovingObject& o : objects) {
    for (const PointId id : o.members) object_of[id] = o.id;
    states[o.map].objects.push_back({o.id, o.motion.centroid.cast<float>(), o.motion.velocity.cast<float>(),
                                     o.motion.extent.cast<float>(), static_cast<std::uint16_t>(o.members.size())});
  }
  for (const MapPoint* p : map.moving_points()) {
    if (p->last_seen != map.now()) continue;
    const auto object = object_of.find(p->id);
    states[p->map].points.push_back({p->id, object == object_of.end() ? ObjectId() : object->second,
                                     p->position.cast<float>(), pack_covariance(p->covariance), cameras_now(map, *p)});
  }
  moving_maps_.clear();
  std::vector<MovingState> out;
  for (auto& [id, s] : states) {
    if (!s.objects.empty() || !s.points.empty()) moving_maps_.insert(id);
    s.server_run = server_run_;
    s.map = id;
    s.epoch = map.epoch();
    s.t_ns = map.now_ns();
    s.scale_known = in_metres.contains(id);
    keep_best(
        s.objects, kMostMovingObjects, [](const auto& a, const auto& b) { return a.points > b.points; }, &s.left_out);
    keep_best(
        s.points, most_moving_points(s.objects.size()),
        [](const auto& a, const auto& b) { return spread(a) < spread(b); }, &s.left_out);
    out.push_back(std::move(s));
  }
  return out;
}

}  // namespace coslam
