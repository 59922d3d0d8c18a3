// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/map/map.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstdlib>
#include <utility>

#include "common/base/check.h"

namespace coslam {
namespace {

constexpr std::size_t kTrackKeepAll = 128;  // newest observations of a track are all kept
constexpr std::size_t kTrackMost = 256;     // beyond, every other of the old ones goes

template <class Frames>
auto find_frame(Frames& frames, SetId set) -> decltype(frames.data()) {
  const auto at =
      std::lower_bound(frames.begin(), frames.end(), set, [](const FramePose& f, SetId s) { return f.set < s; });
  return at == frames.end() || at->set != set ? nullptr : &*at;
}

// Of the time between two frames at an instant: 0 at the one before, 1 at the newer one.
double share_at(const MapCamera& camera, const FramePose& before, const FramePose& now, TimeNs t_ns) {
  return static_cast<double>(t_ns - camera.taken_ns(before)) / static_cast<double>(now.capture_ns - before.capture_ns);
}

// A track may come back to a point, or its point be fused with one that it was bound to before: each observation once.
void sort_observations(MapPoint& p) {
  const auto key = [](const KeyObservation& o) { return std::tie(o.set, o.camera, o.track); };
  auto& all = p.key_observations;
  std::sort(all.begin(), all.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  all.erase(std::unique(all.begin(), all.end(), [&](const auto& a, const auto& b) { return key(a) == key(b); }),
            all.end());
}

bool before(const KeyFrame& a, const KeyFrame& b) { return a.set < b.set; }

// Information about a point, view by view.
class Information {
 public:
  explicit Information(const Eigen::Vector3d& position) : position_(position) {}
  void add(const MapCamera& camera, const Rigid3& pose, double sigma_px) {
    Eigen::Vector2d px;
    Eigen::Matrix<double, 2, 3> j;
    if (project_world(camera.model, pose, position_, &px, &j)) sum_ += j.transpose() * j / (sigma_px * sigma_px);
  }
  Eigen::Matrix3d covariance() const {
    Eigen::Matrix3d a = sum_;
    a.diagonal().array() += 1e-12 * (1e-12 + sum_.trace());  // a single view says nothing about the depth
    return a.inverse();
  }

 private:
  Eigen::Vector3d position_;
  Eigen::Matrix3d sum_ = Eigen::Matrix3d::Zero();
};

void thin_out(std::vector<TrackPoint>& seen) {
  if (seen.size() <= kTrackMost) return;
  const std::size_t old = seen.size() - kTrackKeepAll;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (i >= old || i % 2 == 0) seen[kept++] = seen[i];
  }
  seen.resize(kept);
}

template <class Point>
std::vector<Point*> find_all(auto& map, const std::set<PointId>& ids) {
  std::vector<Point*> out;
  out.reserve(ids.size());
  for (const PointId id : ids) out.push_back(map.find(id));
  return out;
}

}  // namespace

const FramePose* MapCamera::frame_at(SetId set) const { return find_frame(frames, set); }
FramePose* MapCamera::frame_at(SetId set) { return find_frame(frames, set); }

std::optional<Rigid3> MapCamera::pose_at(SetId set, TimeNs t_ns) const {
  constexpr TimeNs kSameInstantNs = 1'000'000;
  const FramePose* f = frame_at(set);
  if (f == nullptr || !f->valid()) return std::nullopt;
  const FramePose* before = f == frames.data() ? nullptr : f - 1;
  if (std::abs(t_ns - taken_ns(*f)) < kSameInstantNs || before == nullptr || before->map != f->map)
    return f->cam_from_world;
  const double share = share_at(*this, *before, *f, t_ns);
  return share >= 0 && share <= 2 ? interpolate(before->cam_from_world, f->cam_from_world, share) : f->cam_from_world;
}

std::optional<View> MapCamera::view_at(MapId in, SetId set, const Sighting& seen, TimeNs t_ns) const {
  const FramePose* f = frame_at(set);
  const auto pose = pose_at(set, t_ns);
  if (!pose || f->map != in) return std::nullopt;
  View view{&model, *pose, seen.undistorted_px.cast<double>()};
  if (f == frames.data()) return view;
  const double share = share_at(*this, *(f - 1), *f, t_ns);
  if (share >= 0 && share <= 2) view.undistorted_px += (share - 1) * seen.step_px.cast<double>();
  return view;
}

MapPoint* Map::find(PointId id) {
  const auto at = points_.find(id);
  return at == points_.end() ? nullptr : &at->second;
}

const MapPoint* Map::find(PointId id) const {
  const auto at = points_.find(id);
  return at == points_.end() ? nullptr : &at->second;
}

CameraId Map::add_camera(const std::string& name, RunId run, const CameraModel& model) {
  MapCamera camera;
  camera.id = CameraId(static_cast<std::uint16_t>(cameras_.size()));
  camera.name = name;
  camera.run = run;
  camera.model = model;
  cameras_.push_back(std::move(camera));
  return cameras_.back().id;
}

void Map::restart_camera(CameraId id, RunId run, const CameraModel& model) {
  MapCamera& c = camera(id);
  for (auto& [track_id, track] : c.tracks) end_track(id, track);
  c.tracks.clear();
  c.run = run;
  c.model = model;
  c.map = MapId();
  c.clock_offset_ns = 0;
  c.alive = true;
}

void Map::ingest(const FrameSet& set) {
  COSLAM_CHECK(set.id.value == 0 || set.id > now_ || cameras_.empty(), "frame sets come in order");
  now_ = set.id;
  now_ns_ = set.t_ns;
  for (const CameraFrame& cf : set.frames) {
    MapCamera& c = camera(cf.camera);
    c.frames.push_back({set.id, cf.frame.frame, cf.frame.capture_ns, {}, {}});
    c.corrected = false;
    for (const TrackObservation& o : cf.frame.tracks) {
      ServerTrack& track = c.tracks[o.track];
      track.id = o.track;
      track.seen.push_back({set.id, o.undistorted_px});
      thin_out(track.seen);
    }
    for (auto at = c.tracks.begin(); at != c.tracks.end();) {
      const bool alive = at->second.seen.back().set == set.id;
      if (!alive) end_track(cf.camera, at->second);
      at = alive ? std::next(at) : c.tracks.erase(at);
    }
    if (cf.patches) {
      for (const ImagePatch& p : cf.patches->patches) {
        const auto at = c.tracks.find(p.track);
        if (at == c.tracks.end()) continue;
        at->second.patch = p.grey;
        at->second.patch_set = set.id;
      }
    }
  }
}

MapPoint& Map::create_point(MapId map, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance, SetId now,
                            TimeNs now_ns) {
  const PointId id(next_point_++);
  MapPoint& p = points_[id];
  p.id = id;
  p.map = map;
  p.position = position;
  p.covariance = covariance;
  p.created = p.last_seen = now;
  p.first_ns = p.last_ns = now_ns;
  return p;
}

void Map::bind(MapPoint& point, CameraId camera_id, ServerTrack& track) {
  COSLAM_CHECK(track.point == PointId(), "a track is bound once");
  track.point = point.id;
  track.gate_failures = 0;
  point.bound.push_back({camera_id, track.id});
  for (const TrackPoint& s : track.seen) {
    if (s.set.value < track.distrusted_before || !keeps_observations_of(s.set, camera_id)) continue;
    point.key_observations.push_back({s.set, camera_id, track.id, s.undistorted_px});
  }
  sort_observations(point);
  give_patch(point, camera_id, track);
}

void Map::give_patch(MapPoint& point, CameraId camera_id, const ServerTrack& track) {
  if (!track.patch) return;
  point.patches.push_back({camera_id, track.patch_set, *track.patch, track.offset_px});
}

void Map::unbind(CameraId camera_id, ServerTrack& track) {
  if (MapPoint* p = find(track.point)) std::erase(p->bound, BoundTrack{camera_id, track.id});
  track.point = PointId();
  track.gate_failures = 0;
  track.offset_px.setZero();
}

void Map::unbind_and_forget(CameraId camera_id, ServerTrack& track) {
  if (MapPoint* p = find(track.point)) {
    std::erase_if(p->key_observations,
                  [&](const KeyObservation& o) { return o.camera == camera_id && o.track == track.id; });
  }
  unbind(camera_id, track);
}

void Map::remove_point(PointId id) {
  MapPoint* p = find(id);
  if (p == nullptr) return;
  const std::vector<BoundTrack> bound = p->bound;
  for (const BoundTrack& b : bound) {
    const auto at = camera(b.camera).tracks.find(b.track);
    if (at != camera(b.camera).tracks.end()) unbind(b.camera, at->second);
  }
  erase_point(id);
}

void Map::erase_point(PointId id) {
  points_.erase(id);
  moving_.erase(id);
}

void Map::set_state(MapPoint& point, PointState state) {
  point.state = state;
  if (state == PointState::kDynamic) {
    moving_.insert(point.id);
  } else {
    moving_.erase(point.id);
  }
}

std::vector<MapPoint*> Map::moving_points() { return find_all<MapPoint>(*this, moving_); }

std::vector<const MapPoint*> Map::moving_points() const { return find_all<const MapPoint>(*this, moving_); }

void Map::end_track(CameraId camera_id, ServerTrack& track) {
  if (MapPoint* p = find(track.point)) std::erase(p->bound, BoundTrack{camera_id, track.id});
}

void Map::fuse(PointId kept, PointId gone) {
  MapPoint* into = find(kept);
  MapPoint* from = find(gone);
  if (into == nullptr || from == nullptr || kept == gone) return;
  for (const BoundTrack& b : from->bound) {
    camera(b.camera).tracks.at(b.track).point = kept;
    into->bound.push_back(b);
  }
  into->key_observations.insert(into->key_observations.end(), from->key_observations.begin(),
                                from->key_observations.end());
  sort_observations(*into);
  into->patches.insert(into->patches.end(), from->patches.begin(), from->patches.end());
  into->views += from->views;
  into->proven |= from->proven;
  if (const auto moved = motions_.find(gone); moved != motions_.end()) {
    auto& path = motions_[kept];
    path.insert(path.end(), moved->second.begin(), moved->second.end());
    std::stable_sort(path.begin(), path.end(), [](const auto& a, const auto& b) { return a.set < b.set; });
    motions_.erase(gone);
  }
  into->last_seen = std::max(into->last_seen, from->last_seen);
  into->first_ns = std::min(into->first_ns, from->first_ns);
  into->last_ns = std::max(into->last_ns, from->last_ns);
  erase_point(gone);
}

bool Map::is_key_frame(SetId set) const {
  return std::binary_search(key_frames_.begin(), key_frames_.end(), KeyFrame{set}, before);
}

bool Map::keeps_observations_of(SetId set, CameraId camera) const {
  return is_key_frame(set) || key_images_.contains({set, camera});
}

void Map::add_key_image(SetId set, CameraId camera_id) {
  if (!key_images_.emplace(set, camera_id).second || is_key_frame(set)) return;
  for (const auto& [id, track] : camera(camera_id).tracks) {
    MapPoint* p = find(track.point);
    if (p == nullptr || track.seen.back().set != set || track.gate_failures > 0) continue;
    p->key_observations.push_back({set, camera_id, id, track.seen.back().undistorted_px});
    sort_observations(*p);
  }
}

void Map::add_key_frame(SetId set) {
  if (is_key_frame(set)) return;
  key_frames_.insert(std::upper_bound(key_frames_.begin(), key_frames_.end(), KeyFrame{set}, before), {set});
  for (auto& [id, p] : points_) {
    for (const BoundTrack& b : p.bound) {
      const ServerTrack& t = camera(b.camera).tracks.at(b.track);
      const auto at = std::lower_bound(t.seen.begin(), t.seen.end(), set,
                                       [](const TrackPoint& s, SetId want) { return s.set < want; });
      if (at == t.seen.end() || at->set != set || set.value < t.distrusted_before || t.gate_failures > 0) continue;
      p.key_observations.push_back({set, b.camera, b.track, at->undistorted_px});
    }
    sort_observations(p);
  }
}

void transform(MapPoint& point, const Similarity3& new_from_old) {
  const Eigen::Matrix3d m = new_from_old.scale * new_from_old.rotation.toRotationMatrix();
  point.position = new_from_old * point.position;
  point.covariance = m * point.covariance * m.transpose();
}

void Map::transform(MapId map, const Similarity3& new_from_old) {
  for (auto& [id, p] : points_) {
    if (p.map == map) coslam::transform(p, new_from_old);
  }
  for (MapCamera& c : cameras_) {
    for (FramePose& f : c.frames) {
      if (f.map == map) f.cam_from_world = transform_world(f.cam_from_world, new_from_old);
    }
    if (c.map == map) c.moved = new_from_old * c.moved;
  }
  raise_epoch();
}

void Map::merge(MapId from, MapId into, const Similarity3& into_from_from) {
  transform(from, into_from_from);
  for (auto& [id, p] : points_) {
    if (p.map == from) p.map = into;
  }
  for (MapCamera& c : cameras_) {
    for (FramePose& f : c.frames) {
      if (f.map == from) f.map = into;
    }
    if (c.map != from) continue;
    c.map = into;
    if (c.merged_from == MapId()) c.merged_from = from;
  }
}

double Map::gate_sigma_px(const MapCamera& c) const {
  return std::clamp(2.5 * c.sigma_px, 1.0, config_.sigma_px * c.model.width_px / 640.0);
}

Eigen::Matrix3d Map::covariance_of(const MapPoint& point) const {
  Information information(point.position);
  struct Ends {
    SetId first, last;
  };
  std::map<std::pair<CameraId, TrackId>, Ends> tracks;
  const auto extend = [&](CameraId camera_id, TrackId track, SetId set) {
    const FramePose* f = camera(camera_id).frame_at(set);
    if (f == nullptr || f->map != point.map) return;  // the newest frame may not have its pose yet
    const auto [at, added] = tracks.try_emplace({camera_id, track}, Ends{set, set});
    at->second.first = std::min(at->second.first, set);
    at->second.last = std::max(at->second.last, set);
  };
  for (const KeyObservation& o : point.key_observations) extend(o.camera, o.track, o.set);
  for (const BoundTrack& b : point.bound) {
    const ServerTrack& t = camera(b.camera).tracks.at(b.track);
    if (t.gate_failures == 0) extend(b.camera, b.track, t.seen.back().set);
  }
  for (const auto& [key, ends] : tracks) {
    const MapCamera& c = camera(key.first);
    information.add(c, c.frame_at(ends.first)->cam_from_world, covariance_sigma_px(c));
    if (ends.last != ends.first) information.add(c, c.frame_at(ends.last)->cam_from_world, covariance_sigma_px(c));
  }
  return information.covariance();
}

Eigen::Matrix3d Map::covariance_of(const Eigen::Vector3d& position,
                                   const std::vector<std::pair<const MapCamera*, const ServerTrack*>>& tracks) const {
  Information information(position);
  for (const auto& [c, track] : tracks) {
    const std::vector<View> ends = views_of(*c, *track, 2);
    for (const View& v : ends) information.add(*c, v.cam_from_world, covariance_sigma_px(*c));
  }
  return information.covariance();
}

std::vector<View> Map::views_of(const MapCamera& c, const ServerTrack& track, std::size_t most) const {
  std::vector<View> views;
  for (const TrackPoint& s : track.seen) {
    if (s.set.value < track.distrusted_before) continue;
    const FramePose* f = c.frame_at(s.set);
    if (f != nullptr && f->valid() && f->map == c.map)
      views.push_back({&c.model, f->cam_from_world, s.undistorted_px.cast<double>()});
  }
  if (views.size() <= most) return views;
  std::vector<View> spread;
  for (std::size_t i = 0; i < most; ++i) spread.push_back(views[i * (views.size() - 1) / (most - 1)]);
  return spread;
}

std::vector<View> Map::key_views_of(const MapPoint& point) const {
  std::vector<View> views;
  for (const KeyObservation& o : point.key_observations) {
    const MapCamera& c = camera(o.camera);
    const FramePose* f = c.frame_at(o.set);
    if (f != nullptr && f->map == point.map)
      views.push_back({&c.model, f->cam_from_world, o.undistorted_px.cast<double>()});
  }
  return views;
}

}  // namespace coslam
