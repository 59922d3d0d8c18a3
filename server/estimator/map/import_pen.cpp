// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/import_pen.h"

#include <algorithm>
#include <string>
#include <utility>

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

}  // namespace

// No agent of here is behind it, and it has no place in a map now.
MapCamera ImportPen::as_here(const MapCamera& other, const Renumbered& renumbered) const {
  MapCamera c = other;
  c.tracks.clear();
  Renumber(renumbered).apply(c);
  c.name = free_name(map_.cameras_, c.name);
  c.run = RunId();
  c.run_since = SetId();
  c.rig.clear();
  c.map = MapId();
  c.merged_from = MapId();
  c.alive = false;
  if (c.past.frames == 0) c.past.until = SetId();
  return c;
}

void ImportPen::take_in_points(const Map& other, const Renumbered& renumbered) {
  for (const auto& [id, point] : other.points()) {
    if (point.moves()) continue;  // nobody sees where it is by now
    MapPoint p = point;
    p.bound.clear();
    p.updated_from.clear();
    Renumber(renumbered).apply(p);
    map_.put(std::move(p));
  }
  for (const auto& [id, path] : other.motions_) {
    Renumber(renumbered).apply(map_.motions_[renumbered.new_id(id)] = path);
  }
}

Renumbered ImportPen::take_in(const Map& other) {
  constexpr TimeNs kBetween_ns = 1'000'000'000;
  Renumbered renumbered;
  renumbered.cameras = static_cast<std::uint16_t>(map_.cameras_.size());
  renumbered.points = map_.next_point_ - 1;
  renumbered.maps = map_.next_map_ - 1;
  renumbered.sets = map_.now_.value + 1;
  renumbered.later_ns = map_.now_ns_ + kBetween_ns - first_ns(other);
  renumbered.moves = map_.moves_.size();
  renumbered.shifted_ns = map_.shifted_ns_ - other.shifted_ns_ - renumbered.later_ns;
  map_.now_ = renumbered.new_id(other.now_);
  map_.now_ns_ = other.now_ns_ + renumbered.later_ns;
  map_.next_point_ += other.next_point_ - 1;
  map_.next_map_ += other.next_map_ - 1;
  for (const MapId id : other.metric_) map_.metric_.insert(renumbered.new_id(id));
  for (const MapCamera& c : other.cameras_) map_.cameras_.push_back(as_here(c, renumbered));
  const auto take_all = [&](const auto& from, auto* to) {
    for (auto value : from) {
      Renumber(renumbered).apply(value);
      to->push_back(value);
    }
  };
  take_all(other.key_frames_, &map_.key_frames_);
  take_all(other.moves_, &map_.moves_);
  for (const auto& [set, camera] : other.key_images_)
    map_.key_images_.emplace(renumbered.new_id(set), renumbered.new_id(camera));
  for (const auto& [set, camera] : other.skipped_key_images_)
    map_.skipped_key_images_.emplace(renumbered.new_id(set), renumbered.new_id(camera));
  take_in_points(other, renumbered);
  raise_epoch();
  return renumbered;
}

}  // namespace coslam
