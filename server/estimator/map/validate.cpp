// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/validate.h"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.h"
#include "common/base/fields.h"
#include "server/estimator/map/map.h"
#include "server/estimator/map/past.h"

namespace coslam {
namespace {

constexpr TimeNs kFarthest_ns = 4'000'000'000'000'000'000;  // the year 2096
constexpr double kFarthest = 1e9;                           // as on the wire, see common/wire/checks.h
constexpr double kRounding = 1e-3;                          // of a squared norm: what products of rotations gather

template <class Vector>
bool is_near(const Vector& v) {
  return v.allFinite() && v.cwiseAbs().maxCoeff() <= static_cast<typename Vector::Scalar>(kFarthest);
}
bool in_range(TimeNs t_ns) { return t_ns >= -kFarthest_ns && t_ns <= kFarthest_ns; }
bool in_range(double value, double low, double high) { return value >= low && value <= high; }
bool is_rotation(const Eigen::Quaterniond& q) { return std::abs(q.squaredNorm() - 1) <= kRounding; }
bool is_sound(const Rigid3& pose) { return is_rotation(pose.rotation) && is_near(pose.translation); }
bool is_sound(const Similarity3& s) {
  return in_range(s.scale, 1 / kFarthest, kFarthest) && is_rotation(s.rotation) && is_near(s.translation);
}
// It becomes the name of a file.
bool is_name(const std::string& name) {
  constexpr std::size_t kLongest = 32;
  const auto good = [](unsigned char c) { return c > ' ' && c < 0x7f && c != '/'; };
  return !name.empty() && name.size() <= kLongest && name.front() != '.' && std::ranges::all_of(name, good);
}

// Goes through a row by the types of its fields. What is wrong is said with the row's table and key, and the field.
class RowCheck {
 public:
  RowCheck(const Map& map, std::string row) : map_(map), row_(std::move(row)) {}

  void require(bool holds, const std::string& message) const {
    if (!holds) throw UserError("the map file cannot be used: " + row_ + ": " + message);
  }

  template <HasFields T>
  void all(const T& value, const std::string& within = "") const {
    each_kept_field(value, [&](const auto& field) { one(field.value, within + field.name); });
  }

 private:
  void one(CameraId id, const std::string& field) const {
    require(id.value < map_.cameras().size(), field + " is a camera that is not there");
  }
  void one(SetId set, const std::string& field) const {
    require(set <= map_.now(), field + " is a frame set of the future");
  }
  void one(MapId id, const std::string& field) const {
    require(id < map_.next_map(), field + " is a map that was never there");
  }
  template <class Tag, class Rep>
  void one(Id<Tag, Rep>, const std::string&) const {}
  void one(TimeNs t_ns, const std::string& field) const { require(in_range(t_ns), field + " is out of time"); }
  template <std::floating_point T>
  void one(T v, const std::string& field) const {
    require(std::abs(static_cast<double>(v)) <= kFarthest, field + " is no number that can be");
  }
  template <std::integral T>
  void one(T, const std::string&) const {}
  void one(TrackMotion motion, const std::string& field) const {
    require(motion <= TrackMotion::kMoving, field + " is of no kind");
  }
  void one(PointPhase phase, const std::string& field) const {
    require(phase <= PointPhase::kMoving, field + " is of no kind");
  }
  template <class Scalar, int kRows, int kCols>
  void one(const Eigen::Matrix<Scalar, kRows, kCols>& m, const std::string& field) const {
    require(m.allFinite(), field + " is not finite");
    require(kCols > 1 || is_near(m), field + " is too far away");
  }
  void one(const Rigid3& pose, const std::string& field) const { require(is_sound(pose), field + " is no pose"); }
  void one(const Similarity3& s, const std::string& field) const { require(is_sound(s), field + " is no similarity"); }
  void one(const std::string&, const std::string&) const {}
  void one(const PatchGrey&, const std::string&) const {}
  void one(const CameraModel& model, const std::string& field) const {
    require(!problem_of(model), field + " is no calibration");
  }
  void one(const LensCorrection& lens, const std::string& field) const { one(lens.values, field); }
  template <class T>
  void one(const std::optional<T>& v, const std::string& field) const {
    if (v) one(*v, field);
  }
  template <class A, class B>
  void one(const std::pair<A, B>& v, const std::string& field) const {
    one(v.first, field);
    one(v.second, field);
  }
  template <class T>
  void one(const std::vector<T>& values, const std::string& field) const {
    for (const T& v : values) one(v, field);
  }
  template <class Key, class Value>
  void one(const std::map<Key, Value>& values, const std::string& field) const {
    for (const auto& entry : values) one(entry, field);
  }
  template <class Key, class Value>
  void one(const FlatMap<Key, Value>& values, const std::string& field) const {
    for (const auto& [key, value] : values) one(value, field + ' ' + std::to_string(key.value));
  }
  template <HasFields T>
  void one(const T& value, const std::string& field) const {
    all(value, field + '.');
  }

  const Map& map_;
  std::string row_;
};

std::string row_of(const char* table, std::uint64_t key) { return std::string(table) + ' ' + std::to_string(key); }

void check_state(const Map& map) {
  const RowCheck row(map, "state");
  row.require(in_range(map.now_ns()) && in_range(map.shifted_ns()), "its time is none");
  for (const MapMove& m : map.moves()) row.all(m, "moves.");
  for (const KeyFrame& k : map.key_frames()) row.all(k, "key_frames.");
  for (const auto* images : {&map.key_images(), &map.skipped_key_images()}) {
    for (const auto& [set, camera] : *images) {
      row.require(set <= map.now() && camera.value < map.cameras().size(), "a key image is of no camera, or to come");
    }
  }
  for (const PointId id : map.untracked_points()) {
    row.require(map.find(id) != nullptr,
                "untracked_points names point " + std::to_string(id.value) + ", which is not there");
  }
}

void check_track(const Map& map, const RowCheck& row, const CameraIdentity& c, TrackId id, const ServerTrack& t) {
  const std::string name = "track " + std::to_string(id.value);
  row.require(t.id == id, name + " has another id");
  const auto later = [](const TrackPoint& a, const TrackPoint& b) { return a.set >= b.set; };
  row.require(std::ranges::adjacent_find(t.seen, later) == t.seen.end(), name + " goes back in time");
  if (!t.bound()) return;
  const MapPoint* point = map.find(t.point);
  row.require(point != nullptr && std::ranges::count(point->bound, BoundTrack{c.id, id}) == 1,
              name + " is bound to a point that does not know of it");
}

void check_camera(const Map& map, const MapCamera& c) {
  constexpr double kMost_px = 1e4, kShortest_s = 1e-5, kLongest_s = 1e5;
  const RowCheck row(map, row_of("camera", c.id.value));
  row.all(c);
  row.require(is_name(c.name), "name cannot be the name of a file");
  row.require(may_be(c.model, c.lens), "lens cannot be");
  row.require(in_range(c.sigma_px, 0, kMost_px), "sigma_px is out of range");
  row.require(in_range(c.scene_depth, 0, kFarthest), "scene_depth is out of range");
  row.require(in_range(c.frame_interval_s, kShortest_s, kLongest_s), "frame_interval_s is out of range");
  const auto fits = [&](const auto& placed) { return placed.second >= 0 && placed.second <= c.past.frames; };
  row.require(c.past.frames >= 0 && std::ranges::all_of(c.past.placed, fits), "past has more placed than frames");
  for (const FramePose& f : c.frames) {
    RowCheck(map, row_of("frame", f.set.value) + " of camera " + std::to_string(c.id.value)).all(f);
  }
  for (const auto& [id, t] : c.tracks) check_track(map, row, c, id, t);
}

void check_point(const Map& map, PointId id, const MapPoint& p) {
  const RowCheck row(map, row_of("point", id.value));
  row.require(p.id == id && id != PointId(), "id is another than its number");
  row.all(p);
  row.require(p.map != MapId(), "map is none");
  row.require(p.updated_from.size() <= map.cameras().size(), "updated_from has more cameras than there are");
  for (const BoundTrack& b : p.bound) {
    const bool known = map.camera(b.camera).tracks.contains(b.track) && map.track(b).point == id;
    row.require(known, "bound names track " + std::to_string(b.track.value) + ", which does not know of it");
  }
}

}  // namespace

void validate(const Map& map) {
  check_state(map);
  for (const MapCamera& c : map.cameras()) check_camera(map, c);
  for (const auto& [id, p] : map.points()) check_point(map, id, p);
  for (const auto& [id, samples] : map.motions()) {
    const RowCheck row(map, row_of("motion", id.value));
    for (const MotionSample& s : samples) row.all(s);
  }
}

void validate(const PastFrames& block, const Map& map) {
  const RowCheck row(map, kPastFramesTable);
  row.all(block.put, "put.");
  row.require(block.camera.value < map.cameras().size(), "camera is a camera that is not there");
  row.require(!block.frames.empty(), "it has no frames");
  for (const FramePose& f : block.frames) row.all(f, "frames.");
}

void validate(const PastPlaces& block, const Map& map) {
  const RowCheck row(map, kPastPlacesTable);
  row.all(block);
  row.require(!block.places.empty(), "it has no places");
}

}  // namespace coslam
