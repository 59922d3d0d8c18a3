// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>

#include "server/map/edit.h"

// A map from elsewhere becomes part of this one: beside its maps, as if it had been made after them.
namespace coslam {
namespace {

std::string free_name(const std::vector<MapCamera>& cameras, const std::string& wanted) {
  constexpr std::size_t kLongest = 32;
  const auto taken = [&](const std::string& name) {
    return std::ranges::any_of(cameras, [&](const MapCamera& c) { return c.name == name; });
  };
  std::string name = wanted;
  for (int i = 2; taken(name); ++i) {
    const std::string mark = "-" + std::to_string(i);
    name = wanted.substr(0, kLongest - mark.size()) + mark;
  }
  return name;
}

TimeNs first_ns(const Map& map) {
  TimeNs first = map.now_ns();
  for (const MapCamera& c : map.cameras()) {
    if (!c.frames.empty()) first = std::min(first, c.frames.front().capture_ns);
    if (c.past.frames > 0) first = std::min(first, c.past.first_ns);
  }
  return first;
}

void renumber(const Renumbered& as, MapPoint* p) {
  p->id = as.of(p->id);
  p->map = as.of(p->map);
  p->created = as.of(p->created);
  p->last_seen = as.of(p->last_seen);
  p->first_ns += as.later_ns;
  p->last_ns += as.later_ns;
  p->bound.clear();
  p->updated_from.clear();
  for (KeyObservation& o : p->key_observations) {
    o.set = as.of(o.set);
    o.camera = as.of(o.camera);
  }
  for (PointPatch& patch : p->patches) {
    patch.set = as.of(patch.set);
    patch.camera = as.of(patch.camera);
  }
}

void renumber(const Renumbered& as, MotionSample* sample) {
  sample->set = as.of(sample->set);
  sample->t_ns += as.later_ns;
  for (Sighting& s : sample->seen) s.camera = as.of(s.camera);
}

}  // namespace

MapCamera MapEdit::as_here(const MapCamera& other, const Renumbered& as) const {
  MapCamera c = other;
  c.id = as.of(c.id);
  c.name = free_name(map_.cameras_, c.name);
  c.run = RunId();
  c.run_since = SetId();
  c.rig.clear();
  c.map = MapId();
  c.merged_from = MapId();
  c.alive = false;
  c.tracks.clear();
  for (FramePose& f : c.frames) {
    f.set = as.of(f.set);
    f.map = as.of(f.map);
    f.capture_ns += as.later_ns;
  }
  c.past.until = c.past.frames > 0 ? as.of(c.past.until) : SetId();
  c.past.first_ns += as.later_ns;
  for (auto& [from_ns, to_ns] : c.past.lost) {
    from_ns += as.later_ns;
    to_ns += as.later_ns;
  }
  c.past.placed.clear();
  for (const auto& [id, frames] : other.past.placed) c.past.placed[as.of(id)] = frames;
  return c;
}

void MapEdit::take_in_points(const Map& other, const Renumbered& as) {
  for (const auto& [other_id, point] : other.points_) {
    if (point.moves()) continue;  // nobody sees where it is by now
    const PointId id = as.of(other_id);
    MapPoint& p = map_.points_[id] = point;
    renumber(as, &p);
    map_.index_.put(id, p);
    if (map_.is_recent(p.last_seen)) map_.recent_.emplace(id, &p);
    for (const KeyObservation& o : p.key_observations) map_.observed_in_[{o.set, o.camera}].push_back(id);
  }
  for (const auto& [id, path] : other.motions_) {
    auto& own_path = map_.motions_[as.of(id)] = path;
    for (MotionSample& sample : own_path) renumber(as, &sample);
  }
}

Renumbered MapEdit::take_in(const Map& other) {
  constexpr TimeNs kBetween_ns = 1'000'000'000;
  Renumbered as;
  as.cameras = static_cast<std::uint16_t>(map_.cameras_.size());
  as.points = map_.next_point_ - 1;
  as.maps = map_.next_map_ - 1;
  as.sets = map_.now_.value + 1;
  as.later_ns = map_.now_ns_ + kBetween_ns - first_ns(other);
  as.moves = map_.moves_.size();
  as.shifted_ns = map_.shifted_ns_ - other.shifted_ns_ - as.later_ns;
  map_.now_ = as.of(other.now_);
  map_.now_ns_ = other.now_ns_ + as.later_ns;
  map_.next_point_ += other.next_point_ - 1;
  map_.next_map_ += other.next_map_ - 1;
  for (const MapId id : other.metric_) map_.metric_.insert(as.of(id));
  for (const MapCamera& c : other.cameras_) map_.cameras_.push_back(as_here(c, as));
  for (const KeyFrame& k : other.key_frames_) map_.key_frames_.push_back({as.of(k.set)});
  for (const auto& [set, camera] : other.key_images_) map_.key_images_.emplace(as.of(set), as.of(camera));
  for (const auto& [set, camera] : other.spared_images_) map_.spared_images_.emplace(as.of(set), as.of(camera));
  for (const MapMove& m : other.moves_) map_.moves_.push_back({as.of(m.from), as.of(m.into), m.into_from_from});
  take_in_points(other, as);
  raise_epoch();
  return as;
}

}  // namespace coslam
