// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/map/map_rows.h"

#include <algorithm>
#include <bit>
#include <concepts>
#include <string>
#include <utility>

#include "server/map/serialise.h"
#include "server/map/sound.h"

namespace coslam {

// What the values of the map are made of.
template <class A>
void serialize(A& a, CameraModel& v) {
  a(v.width_px, v.height_px, v.fx, v.fy, v.cx, v.cy, v.distortion, v.coefficients);
}
template <class A>
void serialize(A& a, LensCorrection& v) {
  a(v.values);
}
template <class A>
void serialize(A& a, TrackPoint& v) {
  a(v.set, v.undistorted_px);
}
template <class A>
void serialize(A& a, ServerTrack& v) {
  a(v.id, v.point, v.seen, v.patch, v.patch_set, v.mapping_after, v.gate_failures, v.distrusted_before, v.motion,
    v.offset_px);
}
template <class A>
void serialize(A& a, HeldTrack& v) {
  a(v.track, v.undistorted_px);
}
template <class A>
void serialize(A& a, FramePose& v) {
  a(v.set, v.frame, v.capture_ns, v.map, v.cam_from_world, v.joint, v.held);
}
template <class A>
void serialize(A& a, MapCamera& v) {  // but for its frames
  a(v.id, v.name, v.run, v.model, v.sigma_px, v.sigma_frames, v.rig, v.cam_from_rig, v.map, v.scene_depth, v.sparse,
    v.lost_sets, v.moved, v.merged_from, v.clock_offset_ns, v.frame_interval_s, v.run_since, v.tracks);
}
template <class A>
void serialize(A& a, KeyObservation& v) {
  a(v.set, v.camera, v.track, v.undistorted_px);
}
template <class A>
void serialize(A& a, PointPatch& v) {
  a(v.camera, v.set, v.pixels, v.offset_px);
}
template <class A>
void serialize(A& a, BoundTrack& v) {
  a(v.camera, v.track);
}
template <class A>
void serialize(A& a, MapPoint& v) {
  a(v.id, v.map, v.phase, v.position, v.covariance, v.created, v.last_seen, v.first_ns, v.last_ns, v.key_observations,
    v.bound, v.patches, v.views, v.updated_from);
}
template <class A>
void serialize(A& a, Sighting& v) {
  a(v.camera, v.undistorted_px, v.step_px);
}
template <class A>
void serialize(A& a, MotionSample& v) {
  a(v.set, v.t_ns, v.seen);
}
template <class A>
void serialize(A& a, KeyFrame& v) {
  a(v.set);
}
template <class A>
void serialize(A& a, MapMove& v) {
  a(v.from, v.into, v.into_from_from);
}
template <class A>
void serialize(A& a, PastFramesCount& v) {
  a(v.until, v.frames, v.placed, v.first_ns, v.lost);
}

namespace {

constexpr int kFrameKeyBits = 32;  // of the set, below the camera

std::int64_t frame_key(CameraId camera, SetId set) {
  return (static_cast<std::int64_t>(camera.value) << kFrameKeyBits) | set.value;
}

// One number that tells two states of a value from each other.
class Likeness {
 public:
  template <std::integral Integer>
  Likeness& operator<<(Integer v) {
    state_ = (state_ ^ static_cast<std::uint64_t>(v)) * 0x9e3779b97f4a7c15U;
    state_ ^= state_ >> 29U;
    return *this;
  }
  Likeness& operator<<(double v) { return *this << std::bit_cast<std::uint64_t>(v); }
  template <class Derived>
  Likeness& operator<<(const Eigen::MatrixBase<Derived>& m) {
    for (int i = 0; i < m.size(); ++i) *this << static_cast<double>(m.derived().coeff(i));
    return *this;
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 1;
};

std::uint64_t likeness(const FramePose& f) {
  return (Likeness() << f.map.value << f.capture_ns << f.cam_from_world.rotation.coeffs()
                     << f.cam_from_world.translation << f.joint << f.held.size())
      .value();
}

// Whatever is added to a point or taken from it shows in one of these.
std::uint64_t likeness(const MapPoint& p) {
  Likeness l;
  l << p.map.value << static_cast<std::uint64_t>(p.phase) << p.last_seen.value << p.views;
  for (const BoundTrack& b : p.bound) l << b.camera.value << b.track.value;
  l << p.first_ns << p.last_ns;
  for (int i = 0; i < 3; ++i) l << p.position[i] << p.covariance(i, i) << p.covariance(i, (i + 1) % 3);
  for (const KeyObservation& o : p.key_observations) l << (std::uint64_t{o.set.value} << 16U | o.camera.value);
  for (const PointPatch& patch : p.patches) l << (std::uint64_t{patch.set.value} << 16U | patch.camera.value);
  for (const Eigen::Vector3d& ray : p.updated_from) l << ray;
  return l.value();
}

// It grows, and takes in others.
std::uint64_t likeness(const std::vector<MotionSample>& path) {
  Likeness l;
  l << path.size();
  if (!path.empty()) l << path.front().t_ns << path.back().t_ns << path.back().set.value << path.back().seen.size();
  return l.value();
}

// Calls visit(value, key) with each row of a table.
template <class Value, class Visit>
void for_each_row(const Tables& tables, const char* table, Visit visit) {
  const auto found = tables.find(table);
  if (found == tables.end()) return;
  for (const auto& [key, octets] : found->second) {
    Value value;
    read_octets(octets, value);
    visit(std::move(value), key);
  }
}

}  // namespace

// Those that are past go, and so do not stay as they were.
void MapRows::frames(const Map& map, std::vector<Row>* rows) {
  frames_.resize(map.cameras().size());
  for (const MapCamera& c : map.cameras()) {
    auto& known = frames_[c.id.value];
    std::vector<std::pair<SetId, std::uint64_t>> all;
    all.reserve(c.frames.size());
    auto once = known.cbegin();
    const auto drop_before = [&](SetId set) {
      for (; once != known.cend() && once->first < set; ++once)
        rows->push_back({"frame", frame_key(c.id, once->first), {}});
    };
    for (const FramePose& f : c.frames) {
      drop_before(f.set);
      all.emplace_back(f.set, likeness(f));
      const bool was_there = once != known.cend() && once->first == f.set;
      if (!was_there || once->second != all.back().second) {
        rows->push_back({"frame", frame_key(c.id, f.set), octets_of(f)});
      }
      if (was_there) ++once;
    }
    drop_before(SetId(0xffffffff));
    known = std::move(all);
  }
}

template <class Value>
void MapRows::keep(const char* table, const std::map<PointId, Value>& values, Known* known, std::vector<Row>* rows) {
  for (const auto& [id, value] : values) {
    const std::uint64_t now = likeness(value);
    const auto [at, added] = known->try_emplace(id, now);
    if (!added && at->second == now) continue;
    at->second = now;
    rows->push_back({table, id.value, octets_of(value)});
  }
  if (known->size() == values.size()) return;
  std::erase_if(*known, [&](const auto& once) {
    if (values.contains(once.first)) return false;
    rows->push_back({table, once.first.value, {}});
    return true;
  });
}

std::vector<Row> MapRows::changes(const Map& map) {
  std::vector<Row> rows;
  if (std::exchange(lens_changes_, map.lens_changes_) != map.lens_changes_) {
    // All that was observed through those lenses lies elsewhere by now.
    for (auto* known : {&points_, &motions_}) {
      for (auto& [id, likeness_before] : *known) ++likeness_before;
    }
    for (auto& known : frames_) {
      for (auto& [set, likeness_before] : known) ++likeness_before;
    }
  }
  frames(map, &rows);
  keep("point", map.points(), &points_, &rows);
  keep("motion", map.motions(), &motions_, &rows);
  for (const MapCamera& c : map.cameras()) rows.push_back({"camera", c.id.value, octets_of(c)});
  rows.push_back({"state", static_cast<std::int64_t>(StateRow::kMap),
                  octets_of(map.metric_, map.key_frames_, map.key_images_, map.loose_, map.repatched_, map.next_point_,
                            map.next_map_, map.epoch_, map.now_, map.now_ns_, map.set_interval_s_, map.set_times_ns_)});
  std::vector<PastFramesCount> past;
  for (const MapCamera& c : map.cameras()) past.push_back(c.past);
  rows.push_back({"state", static_cast<std::int64_t>(StateRow::kPast), octets_of(map.moves_, map.shifted_ns_, past)});
  rows.push_back({"state", static_cast<std::int64_t>(StateRow::kSpared), octets_of(map.spared_images_)});
  std::vector<LensCorrection> lenses;
  for (const MapCamera& c : map.cameras()) lenses.push_back(c.lens);
  rows.push_back({"state", static_cast<std::int64_t>(StateRow::kLenses), octets_of(lenses)});
  return rows;
}

void MapRows::restore(const Tables& tables, Map* map) {
  read_state(tables, StateRow::kMap, map->metric_, map->key_frames_, map->key_images_, map->loose_, map->repatched_,
             map->next_point_, map->next_map_, map->epoch_, map->now_, map->now_ns_, map->set_interval_s_,
             map->set_times_ns_);
  constexpr double kShortest_s = 1e-5, kLongest_s = 1e5;
  if (!(map->set_interval_s_ >= kShortest_s && map->set_interval_s_ <= kLongest_s) || map->next_map_ == 0)
    throw UserError("the map file has a state that cannot be");
  for_each_row<MapCamera>(tables, "camera", [&](MapCamera camera, std::int64_t) {
    if (camera.id.value != map->cameras_.size()) throw UserError("the map file lacks a camera");
    camera.alive = false;
    map->cameras_.push_back(std::move(camera));
  });
  std::vector<PastFramesCount> past;  // none in a file of version 1
  read_state(tables, StateRow::kPast, map->moves_, map->shifted_ns_, past);
  read_state(tables, StateRow::kSpared, map->spared_images_);  // none in older files
  if (past.size() > map->cameras_.size()) throw UserError("the map file has a past of no camera");
  std::vector<LensCorrection> lenses;  // none in older files
  read_state(tables, StateRow::kLenses, lenses);
  if (lenses.size() > map->cameras_.size()) throw UserError("the map file has a lens of no camera");
  for (std::size_t i = 0; i < lenses.size(); ++i) map->cameras_[i].lens = lenses[i];
  for (std::size_t i = 0; i < past.size(); ++i) map->cameras_[i].past = std::move(past[i]);
  for_each_row<FramePose>(tables, "frame", [&](FramePose frame, std::int64_t key) {
    const auto camera = static_cast<std::size_t>(key >> kFrameKeyBits);
    if (camera >= map->cameras_.size() || frame_key(CameraId(static_cast<std::uint16_t>(camera)), frame.set) != key)
      throw UserError("the map file has a frame of no camera");
    map->cameras_[camera].frames.push_back(std::move(frame));
  });
  for_each_row<std::vector<MotionSample>>(tables, "motion", [&](std::vector<MotionSample> samples, std::int64_t key) {
    map->motions_[PointId(static_cast<std::uint32_t>(key))] = std::move(samples);
  });
  for_each_row<MapPoint>(tables, "point", [&](MapPoint point, std::int64_t) {
    const PointId id = point.id;
    MapPoint& p = map->points_[id] = std::move(point);
    map->index_.put(id, p);
    if (p.moves()) map->moving_.emplace(id, &p);
    if (map->is_recent(p.last_seen)) map->recent_.emplace(id, &p);
    for (const KeyObservation& o : p.key_observations) map->observed_in_[{o.set, o.camera}].push_back(id);
  });
  if (!map->points_.empty() && map->points_.rbegin()->first.value >= map->next_point_)
    throw UserError("the map file has a point of no number");
  require_sound(*map);
}

}  // namespace coslam
