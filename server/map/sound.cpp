// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/map/sound.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/base/error.h"
#include "server/map/map.h"
#include "server/map/past.h"

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

void require(bool holds, const char* what) {
  if (!holds) throw UserError(std::string("the map file has ") + what);
}

class Check {
 public:
  explicit Check(const Map& map) : map_(map) {}

  void all() const {
    state();
    for (const MapCamera& c : map_.cameras()) camera(c);
    for (const auto& [id, p] : map_.points()) point(id, p);
    for (const auto& [id, samples] : map_.motions()) {
      for (const MotionSample& s : samples) motion(s);
    }
  }

  void past(const PastFrames& block) const {
    require(is_there(block.camera) && in_range(block.put.shifted_ns) && !block.frames.empty(), "a past of no camera");
    for (const FramePose& f : block.frames) frame(f);
  }

  void past(const PastPlaces& block) const {
    require(in_range(block.put.shifted_ns) && !block.places.empty(), "a path of the past that leads nowhere");
    for (const PastPlace& p : block.places) {
      require(is_there(p.camera) && is_past(p.set) && is_map(p.map) && in_range(p.t_ns),
              "a path of the past that was never");
      require(is_near(p.p_in_cam) && p.covariance_in_cam.allFinite(), "a path of the past that is nowhere");
    }
  }

 private:
  bool is_there(CameraId id) const { return id.value < map_.cameras().size(); }
  bool is_past(SetId set) const { return set <= map_.now(); }
  bool is_map(MapId id) const { return id < map_.next_map(); }

  void state() const {
    require(in_range(map_.now_ns()) && in_range(map_.shifted_ns()), "a time that is none");
    for (const MapMove& m : map_.moves()) {
      require(is_map(m.from) && is_map(m.into) && is_sound(m.into_from_from), "a map that moved to nowhere");
    }
    for (const auto& [set, id] : map_.key_images()) require(is_past(set) && is_there(id), "a key image of no camera");
    for (const auto& [set, id] : map_.spared_images())
      require(is_past(set) && is_there(id), "a key frame of no camera");
    for (const KeyFrame& k : map_.key_frames()) require(is_past(k.set), "a key frame of the future");
    for (const PointId id : map_.loose_points()) require(map_.find(id) != nullptr, "a loose point that is not there");
  }

  void camera(const MapCamera& c) const {
    constexpr double kMost_px = 1e4, kShortest_s = 1e-5, kLongest_s = 1e5;
    require(is_name(c.name), "a camera without a name");
    require(!problem_of(c.model), "a camera without a calibration");
    require(may_be(c.model, c.lens), "a camera with a lens that cannot be");
    require(in_range(c.sigma_px, 0, kMost_px) && in_range(c.scene_depth, 0, kFarthest), "a camera that cannot be");
    require(in_range(c.frame_interval_s, kShortest_s, kLongest_s) && in_range(c.clock_offset_ns),
            "a camera out of time");
    require(is_map(c.map) && is_map(c.merged_from) && is_sound(c.moved) && is_sound(c.cam_from_rig),
            "a camera of no map");
    require(c.past.frames >= 0 && std::ranges::all_of(c.past.placed,
                                                      [&](const auto& p) {
                                                        return is_map(p.first) && p.second >= 0 &&
                                                               p.second <= c.past.frames;
                                                      }),
            "a past that cannot be");
    for (const FramePose& f : c.frames) frame(f);
    for (const auto& [id, t] : c.tracks) track(c, id, t);
  }

  void frame(const FramePose& f) const {
    require(is_past(f.set) && in_range(f.capture_ns) && is_map(f.map), "a frame that cannot be");
    require(!f.valid() || is_sound(f.cam_from_world), "a frame whose pose is none");
    for (const HeldTrack& h : f.held) require(is_near(h.undistorted_px), "a frame that saw nothing");
  }

  void track(const MapCamera& c, TrackId id, const ServerTrack& t) const {
    require(t.id == id && is_past(t.patch_set) && is_near(t.offset_px), "a track that cannot be");
    require(t.motion <= TrackMotion::kMoving, "a track of no kind");
    const auto later = [](const TrackPoint& a, const TrackPoint& b) { return a.set >= b.set; };
    require(std::ranges::adjacent_find(t.seen, later) == t.seen.end(), "a track that goes back in time");
    for (const TrackPoint& p : t.seen) require(is_past(p.set) && is_near(p.undistorted_px), "a track of nothing");
    if (!t.bound()) return;
    const MapPoint* point = map_.find(t.point);
    require(point != nullptr && std::ranges::count(point->bound, BoundTrack{c.id, id}) == 1, "a track on no point");
  }

  void point(PointId id, const MapPoint& p) const {
    require(p.id == id && id != PointId() && is_map(p.map) && p.map != MapId(), "a point that cannot be");
    require(p.phase <= PointPhase::kMoving, "a point of no kind");
    require(is_near(p.position) && p.covariance.allFinite(), "a point that is nowhere");
    require(is_past(p.created) && is_past(p.last_seen) && in_range(p.first_ns) && in_range(p.last_ns),
            "a point that was never");
    for (const KeyObservation& o : p.key_observations) {
      require(is_there(o.camera) && is_past(o.set) && is_near(o.undistorted_px), "a point that nobody saw");
    }
    for (const PointPatch& patch : p.patches) {
      require(is_there(patch.camera) && is_past(patch.set) && is_near(patch.offset_px),
              "a point that looks like nothing");
    }
    require(p.updated_from.size() <= map_.cameras().size(), "a point of cameras that are not there");
    for (const Eigen::Vector3d& ray : p.updated_from) require(is_near(ray), "a point seen from nowhere");
    for (const BoundTrack& b : p.bound) {
      const bool known =
          is_there(b.camera) && map_.camera(b.camera).tracks.contains(b.track) && map_.track(b).point == id;
      require(known, "a point on no track");
    }
  }

  void motion(const MotionSample& sample) const {
    require(is_past(sample.set) && in_range(sample.t_ns), "a path out of time");
    for (const Sighting& s : sample.seen) {
      require(is_there(s.camera) && is_near(s.undistorted_px) && is_near(s.step_px), "a path that nobody saw");
    }
  }

  const Map& map_;
};

}  // namespace

void require_sound(const Map& map) { Check(map).all(); }
void require_sound(const PastFrames& block, const Map& map) { Check(map).past(block); }
void require_sound(const PastPlaces& block, const Map& map) { Check(map).past(block); }

}  // namespace coslam
