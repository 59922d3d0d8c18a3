// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/map.h"

#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace coslam {
namespace {

bool before(const KeyFrame& a, const KeyFrame& b) { return a.set < b.set; }

// Information about a point, view by view.
class Information {
 public:
  explicit Information(const Eigen::Vector3d& position) : position_(position) {}
  void add(const CameraLens& camera, const Rigid3& pose, double sigma_px) {
    Eigen::Vector2d px;
    Eigen::Matrix<double, 2, 3> j;
    if (!project_world(camera.model, pose, position_, &px, &j)) return;
    j = (camera.model.raw_by_undistorted(px) * j).eval();
    sum_ += j.transpose() * j / (sigma_px * sigma_px);
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

// The first and the last view of each track that ever showed the point.
class TrackEnds {
 public:
  TrackEnds(const Map& map, const MapPoint& point) : map_(map), map_id_(point.map) {
    for (const KeyObservation& o : point.key_observations) extend(o.camera, o.track, o.set);
    for (const BoundTrack& b : point.bound) {
      const ServerTrack& t = map.track(b);
      if (t.gate_failures == 0) extend(b.camera, b.track, t.seen.back().set);
    }
    std::ranges::sort(tracks_, {}, [](const Ends& e) { return std::pair(e.camera, e.track); });
  }
  // visit(camera, pose), by camera and track.
  void each(auto&& visit) const {
    for (const Ends& e : tracks_) {
      visit(map_.camera(e.camera), e.first->cam_from_world);
      if (e.last != e.first) visit(map_.camera(e.camera), e.last->cam_from_world);
    }
  }

 private:
  struct Ends {
    CameraId camera;
    TrackId track;
    const FramePose *first, *last;
  };
  void extend(CameraId camera, TrackId track, SetId set) {
    const FramePose* f = map_.camera(camera).frame_at(set);
    if (f == nullptr || f->map != map_id_) return;  // the newest frame may not have its pose yet
    // Mostly one of the newest: they come in the order of time.
    const auto same = [&](const Ends& e) { return e.camera == camera && e.track == track; };
    const auto at = std::find_if(tracks_.rbegin(), tracks_.rend(), same);
    if (at == tracks_.rend()) {
      tracks_.push_back({camera, track, f, f});
      return;
    }
    if (f->set < at->first->set) at->first = f;
    if (f->set > at->last->set) at->last = f;
  }

  const Map& map_;
  MapId map_id_;
  std::vector<Ends> tracks_;
};

}  // namespace

std::uint32_t Map::sets_in(double time_s) const {
  return static_cast<std::uint32_t>(std::max(1L, std::lround(time_s / set_interval_s_)));
}

PointState told_state(PointPhase phase) {
  switch (phase) {
    case PointPhase::kMoving:
      return PointState::kDynamic;
    case PointPhase::kTrial:
    case PointPhase::kStatic:
      break;
  }
  return PointState::kStatic;
}

bool seen_by(const MapPoint& point, CameraId camera) {
  return std::any_of(point.bound.begin(), point.bound.end(), [&](const BoundTrack& b) { return b.camera == camera; });
}

bool seen_at_once(const MapPoint& p, const MapPoint& q) {
  return std::any_of(p.bound.begin(), p.bound.end(), [&](const BoundTrack& b) { return seen_by(q, b.camera); });
}

Map::Map(const MapConfig& config) : config_(config) {
  for (const std::string& text : config.rigs) rigs_.push_back(parse_rig_camera(text));
}

void Map::put(MapPoint point) {
  const PointId id = point.id;
  MapPoint& p = points_.all[id] = std::move(point);
  points_.index(p, is_recent(p.last_seen));
  for (const KeyObservation& o : p.key_observations) observed_in_[{o.set, o.camera}].push_back(id);
}

std::vector<CameraId> Map::rig_mates(const CameraIdentity& camera) const {
  std::vector<CameraId> out;
  for (const MapCamera& c : cameras_) {
    if (!camera.rig.empty() && c.rig == camera.rig && c.id != camera.id) out.push_back(c.id);
  }
  return out;
}

bool Map::is_key_frame(SetId set) const {
  return std::binary_search(key_frames_.begin(), key_frames_.end(), KeyFrame{set}, before);
}

bool Map::keeps_observations_of(SetId set, CameraId camera) const {
  if (key_images_.contains({set, camera})) return true;
  return is_key_frame(set) && !skipped_key_images_.contains({set, camera});
}

namespace {

// Ascending, each once. Where they lie close to each other they are not sorted but marked.
std::vector<PointId> in_order(std::vector<PointId> ids) {
  if (ids.empty()) return ids;
  constexpr std::size_t kBits = 64;
  std::uint32_t low = ids.front().value, high = low;
  for (const PointId id : ids) {
    low = std::min(low, id.value);
    high = std::max(high, id.value);
  }
  const std::size_t words = (high - low) / kBits + 1;
  if (words > ids.size()) {
    std::ranges::sort(ids);
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    return ids;
  }
  std::vector<std::uint64_t> marks(words);
  for (const PointId id : ids) {
    const std::size_t above = id.value - low;
    marks[above / kBits] |= std::uint64_t{1} << above % kBits;
  }
  ids.clear();
  for (std::size_t word = 0; word < words; ++word) {
    for (std::uint64_t left = marks[word]; left != 0; left &= left - 1) {
      ids.emplace_back(low + static_cast<std::uint32_t>(word * kBits) +
                       static_cast<std::uint32_t>(std::countr_zero(left)));
    }
  }
  return ids;
}

}  // namespace

std::vector<const MapPoint*> Map::found(std::vector<PointId> given) const {
  const std::vector<PointId> ids = in_order(std::move(given));
  std::vector<const MapPoint*> out;
  out.reserve(ids.size());
  for (const PointId id : ids) {
    if (const MapPoint* p = find(id)) out.push_back(p);
  }
  return out;
}

std::vector<const MapPoint*> Map::moving_points() const {
  std::vector<const MapPoint*> out;
  out.reserve(points_.moving.size());
  for (const auto& [id, p] : points_.moving) out.push_back(p);
  return out;
}

std::vector<const MapPoint*> Map::recent_points() const {
  std::vector<const MapPoint*> out;
  out.reserve(points_.recent.size());
  const SetId first_set = set_ago(config_.recent_s);
  for (const auto& [id, p] : points_.recent) {
    if (p->last_seen >= first_set) out.push_back(p);
  }
  return out;
}

std::vector<const MapPoint*> Map::points_seen_since(SetId set) const {
  std::vector<const MapPoint*> out;
  if (is_recent(set)) {
    for (const MapPoint* p : recent_points()) {
      if (p->last_seen >= set) out.push_back(p);
    }
    return out;
  }
  for (const auto& [id, p] : points_.all) {
    if (p.last_seen >= set) out.push_back(&p);
  }
  return out;
}

std::vector<const MapPoint*> Map::points_observed_in(const std::vector<ImageKey>& images) const {
  std::vector<PointId> ids;
  for (const ImageKey& image : images) {
    const auto at = observed_in_.find(image);
    if (at != observed_in_.end()) ids.insert(ids.end(), at->second.begin(), at->second.end());
  }
  return found(std::move(ids));
}

std::vector<const MapPoint*> Map::points_observed_at(const std::vector<SetId>& sets) const {
  std::vector<PointId> ids;
  for (const SetId set : sets) {
    for (auto at = observed_in_.lower_bound({set, CameraId(0)}); at != observed_in_.end() && at->first.first == set;
         ++at) {
      ids.insert(ids.end(), at->second.begin(), at->second.end());
    }
  }
  return found(std::move(ids));
}

std::vector<const MapPoint*> Map::points_observed_since(SetId set) const {
  std::vector<PointId> ids;
  for (auto at = observed_in_.lower_bound({set, CameraId(0)}); at != observed_in_.end(); ++at) {
    ids.insert(ids.end(), at->second.begin(), at->second.end());
  }
  return found(std::move(ids));
}

double Map::gate_sigma_px(const CameraLens& c) const {
  return std::min(std::max(2.5 * c.sigma_px, 1.0), sigma_bound_px(c));
}

Eigen::Matrix3d Map::covariance_of(const MapPoint& point, const Eigen::Vector3d& position) const {
  Information information(position);
  TrackEnds(*this, point).each([&](const MapCamera& c, const Rigid3& pose) {
    information.add(c, pose, covariance_sigma_px(c));
  });
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
