// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/map_rows.h"

#include <algorithm>
#include <string>
#include <utility>

#include "server/estimator/map/fingerprint.h"
#include "server/estimator/map/serialise.h"
#include "server/estimator/map/validate.h"

namespace coslam {

namespace {

constexpr int kFrameKeyBits = 32;  // of the set, below the camera

std::int64_t frame_key(CameraId camera, SetId set) {
  return (static_cast<std::int64_t>(camera.value) << kFrameKeyBits) | set.value;
}

// Calls visit(value, key) with each row of a table.
template <class Value, class Visit>
void for_each_row(const Tables& tables, int version, const char* table, Visit visit) {
  const auto found = tables.find(table);
  if (found == tables.end()) return;
  for (const auto& [key, octets] : found->second) {
    Value value;
    read_octets_of(version, octets, value);
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
      all.emplace_back(f.set, fingerprint(f));
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
    const std::uint64_t now = fingerprint(value);
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
  frames(map, &rows);
  keep("point", map.points(), &points_, &rows);
  keep("motion", map.motions(), &motions_, &rows);
  for (const MapCamera& c : map.cameras()) rows.push_back({"camera", c.id.value, octets_of(c)});
  rows.push_back(
      {"state", static_cast<std::int64_t>(StateRow::kMap),
       octets_of(map.metric_, map.key_frames_, map.key_images_, map.untracked_, map.repatched_, map.next_point_,
                 map.next_map_, map.epoch_, map.now_, map.now_ns_, map.set_interval_s_, map.set_times_ns_)});
  rows.push_back({"state", static_cast<std::int64_t>(StateRow::kPast), octets_of(map.moves_, map.shifted_ns_)});
  rows.push_back({"state", static_cast<std::int64_t>(StateRow::kSpared), octets_of(map.skipped_key_images_)});
  return rows;
}

void MapRows::write_all_again() {
  for (auto* known : {&points_, &motions_}) {
    for (auto& [id, before] : *known) ++before;
  }
  for (auto& known : frames_) {
    for (auto& [set, before] : known) ++before;
  }
}

// What files before version 3 had beside the rows of cameras.
void MapRows::restore_cameras_apart(const Tables& tables, Map* map) {
  std::vector<PastFramesCount> past;  // none in a file of version 1
  read_state(tables, StateRow::kPast, map->moves_, map->shifted_ns_, past);
  std::vector<LensCorrection> lenses;
  read_state(tables, StateRow::kLenses, lenses);
  const std::size_t cameras = map->cameras_.size();
  if (past.size() > cameras || lenses.size() > cameras)
    throw UserError("the map file has a lens or a past of no camera");
  for (std::size_t i = 0; i < lenses.size(); ++i) map->cameras_[i].lens = lenses[i];
  for (std::size_t i = 0; i < past.size(); ++i) map->cameras_[i].past = std::move(past[i]);
}

void MapRows::restore(const Tables& tables, int version, Map* map) {
  read_state(tables, StateRow::kMap, map->metric_, map->key_frames_, map->key_images_, map->untracked_, map->repatched_,
             map->next_point_, map->next_map_, map->epoch_, map->now_, map->now_ns_, map->set_interval_s_,
             map->set_times_ns_);
  constexpr double kShortest_s = 1e-5, kLongest_s = 1e5;
  if (!(map->set_interval_s_ >= kShortest_s && map->set_interval_s_ <= kLongest_s) || map->next_map_ == 0)
    throw UserError("the map file has a state that cannot be");
  for_each_row<MapCamera>(tables, version, "camera", [&](MapCamera camera, std::int64_t) {
    if (camera.id.value != map->cameras_.size()) throw UserError("the map file lacks a camera");
    camera.alive = false;
    map->cameras_.push_back(std::move(camera));
  });
  read_state(tables, StateRow::kSpared, map->skipped_key_images_);  // none in older files
  if (version < 3) {
    restore_cameras_apart(tables, map);
  } else {
    read_state(tables, StateRow::kPast, map->moves_, map->shifted_ns_);
  }
  for_each_row<FramePose>(tables, version, "frame", [&](FramePose frame, std::int64_t key) {
    const auto camera = static_cast<std::size_t>(key >> kFrameKeyBits);
    if (camera >= map->cameras_.size() || frame_key(CameraId(static_cast<std::uint16_t>(camera)), frame.set) != key)
      throw UserError("the map file has a frame of no camera");
    map->cameras_[camera].frames.push_back(std::move(frame));
  });
  for_each_row<std::vector<MotionSample>>(
      tables, version, "motion", [&](std::vector<MotionSample> samples, std::int64_t key) {
        map->motions_[PointId(static_cast<std::uint32_t>(key))] = std::move(samples);
      });
  for_each_row<MapPoint>(tables, version, "point", [&](MapPoint point, std::int64_t) { map->put(std::move(point)); });
  if (!map->points().empty() && map->points().rbegin()->first.value >= map->next_point_)
    throw UserError("the map file has a point of no number");
  validate(*map);
}

}  // namespace coslam
