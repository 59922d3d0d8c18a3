// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/stages/start.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/pose_refinement.h"
#include "server/stages/refine.h"
#include "server/stages/register.h"

namespace coslam {
namespace {

// Descriptors of this set's images go to their tracks, and with them to their points.
void take_descriptors(Map& map, const FrameSet& set) {
  for (const CameraFrame& cf : set.frames) {
    if (!cf.descriptors) continue;
    MapCamera& camera = map.camera(cf.camera);
    for (std::size_t i = 0; i < cf.descriptors->tracks.size(); ++i) {
      const auto at = camera.tracks.find(cf.descriptors->tracks[i]);
      if (at == camera.tracks.end()) continue;
      const auto begin = cf.descriptors->descriptors.begin() + static_cast<std::ptrdiff_t>(i * kDescriptorBytes);
      at->second.descriptor.assign(begin, begin + kDescriptorBytes);
      MapPoint* p = map.find(at->second.point);
      if (p != nullptr && p->descriptor.empty()) p->descriptor = at->second.descriptor;
    }
  }
}

// Features of one camera at this set: those of its tracks that have a descriptor, in track order.
struct TrackFeatures {
  FeatureImage image;
  std::vector<TrackId> tracks;
};

TrackFeatures features_of(const Map& map, const CameraFrame& cf) {
  TrackFeatures out;
  const MapCamera& camera = map.camera(cf.camera);
  out.image.camera = camera.model;
  if (!cf.descriptors) return out;
  for (const TrackId id : cf.descriptors->tracks) {
    const auto at = camera.tracks.find(id);
    if (at == camera.tracks.end() || at->second.descriptor.empty()) continue;
    out.tracks.push_back(id);
    out.image.undistorted_px.push_back(at->second.seen.back().undistorted_px.cast<double>());
    out.image.descriptors.insert(out.image.descriptors.end(), at->second.descriptor.begin(),
                                 at->second.descriptor.end());
  }
  return out;
}

void localise_backwards(Map& map, MapCamera& camera, SetId from, const LocaliseConfig& config) {
  const FramePose* known = camera.frame_at(from);
  Rigid3 pose = known->cam_from_world;
  for (std::size_t i = camera.frames.size(); i-- > 0;) {
    FramePose& f = camera.frames[i];
    if (f.set >= from) continue;
    if (f.valid()) break;
    if (!localise_past(map, camera, f.set, pose, config)) break;
    pose = f.cam_from_world;
  }
}

void set_pose(MapCamera& camera, SetId set, MapId map, const Rigid3& pose) {
  FramePose* f = camera.frame_at(set);
  f->map = map;
  f->cam_from_world = pose;
  camera.map = map;
  camera.lost_sets = 0;
}

MapPoint& add_start_point(Map& map, MapId id, const Eigen::Vector3d& position, const std::vector<View>& views,
                          const FrameSet& set) {
  return map.create_point(id, position, triangulation_covariance(views, position, 1.5), set.id, set.t_ns);
}

// Its points have to stand still for a while before anything else rests on them.
void put_to_the_proof(Map& map, MapId of) {
  for (auto& [id, p] : map.points()) {
    if (p.map == of) p.proven = false;
  }
}

// All unplaced cameras with descriptors at once.
void start_together(Map& map, const FrameSet& set, const StartStageConfig& config, StartReport* report) {
  std::vector<TrackFeatures> features;
  std::vector<CameraId> cameras;
  for (const CameraFrame& cf : set.frames) {
    if (map.camera(cf.camera).map != MapId() || !cf.descriptors) continue;
    features.push_back(features_of(map, cf));
    cameras.push_back(cf.camera);
  }
  if (cameras.size() < 2) return;
  std::vector<FeatureImage> images;
  for (const TrackFeatures& f : features) images.push_back(f.image);
  const StartResult result = start_map(images, config.pair);
  if (!result.ok) {
    report->reason = result.reason;
    return;
  }
  const MapId id = map.new_map();
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (result.cam_from_world[i]) set_pose(map.camera(cameras[i]), set.id, id, *result.cam_from_world[i]);
  }
  for (const StartResult::Point& p : result.points) {
    std::vector<View> views;
    for (const auto& [image, feature] : p.seen) {
      const auto i = static_cast<std::size_t>(image);
      views.push_back({&map.camera(cameras[i]).model, *result.cam_from_world[i],
                       images[i].undistorted_px[static_cast<std::size_t>(feature)]});
    }
    MapPoint& point = add_start_point(map, id, p.position, views, set);
    for (const auto& [image, feature] : p.seen) {
      MapCamera& camera = map.camera(cameras[static_cast<std::size_t>(image)]);
      ServerTrack& track =
          camera.tracks.at(features[static_cast<std::size_t>(image)].tracks[static_cast<std::size_t>(feature)]);
      if (track.point == PointId()) map.bind(point, camera.id, track);
    }
  }
  map.add_key_frame(set.id);
  for (const CameraId c : cameras) {
    if (map.camera(c).map == id) localise_backwards(map, map.camera(c), set.id, config.localise);
  }
  put_to_the_proof(map, id);
  map.raise_epoch();
  ++report->started;
}

// Tracks that the camera has now and had at an earlier set.
struct Common {
  SetId set;
  std::vector<TrackId> tracks;
  FeatureImage then, now;
  std::vector<FeatureMatch> matches;
  double median_flow_px = 0;
};

Common common_tracks(const MapCamera& camera, SetId then) {
  Common c;
  c.set = then;
  c.then.camera = c.now.camera = camera.model;
  std::vector<double> flow;
  for (const auto& [id, t] : camera.tracks) {
    const auto at = std::lower_bound(t.seen.begin(), t.seen.end(), then,
                                     [](const TrackPoint& s, SetId want) { return s.set < want; });
    if (at == t.seen.end() || at->set != then) continue;
    const int i = static_cast<int>(c.tracks.size());
    c.tracks.push_back(id);
    c.then.undistorted_px.push_back(at->undistorted_px.cast<double>());
    c.now.undistorted_px.push_back(t.seen.back().undistorted_px.cast<double>());
    c.matches.push_back({i, i, 0});
    flow.push_back((c.then.undistorted_px.back() - c.now.undistorted_px.back()).norm());
  }
  if (!flow.empty()) {
    std::nth_element(flow.begin(), flow.begin() + static_cast<std::ptrdiff_t>(flow.size() / 2), flow.end());
    c.median_flow_px = flow[flow.size() / 2];
  }
  return c;
}

// The oldest set of which enough tracks are left.
std::optional<Common> widest_common(const MapCamera& camera) {
  const std::size_t enough = std::max<std::size_t>(60, camera.tracks.size() * 2 / 5);
  for (const FramePose& f : camera.frames) {
    if (f.valid() || f.set == camera.frames.back().set) continue;
    std::size_t n = 0;
    for (const auto& [id, t] : camera.tracks) n += t.seen.front().set <= f.set;
    if (n >= enough) return common_tracks(camera, f.set);
  }
  return std::nullopt;
}

int sets_without_map(const MapCamera& camera) {
  int n = 0;
  for (std::size_t i = camera.frames.size(); i-- > 0 && !camera.frames[i].valid();) ++n;
  return n;
}

// Two views of one camera at different times.
void start_alone(Map& map, MapCamera& camera, const FrameSet& set, const StartStageConfig& config,
                 StartReport* report) {
  const std::optional<Common> common = widest_common(camera);
  if (!common || common->median_flow_px < config.min_flow_px * camera.model.width_px / 640.0) return;
  const StartResult result = start_from_matches(common->then, common->now, common->matches, config.pair);
  if (!result.ok) {
    report->reason = result.reason;
    return;
  }
  const MapId id = map.new_map();
  set_pose(camera, common->set, id, *result.cam_from_world[0]);
  set_pose(camera, set.id, id, *result.cam_from_world[1]);
  for (const StartResult::Point& p : result.points) {
    const auto i = static_cast<std::size_t>(p.seen.front().second);
    const std::vector<View> views{{&camera.model, *result.cam_from_world[0], common->then.undistorted_px[i]},
                                  {&camera.model, *result.cam_from_world[1], common->now.undistorted_px[i]}};
    map.bind(add_start_point(map, id, p.position, views, set), camera.id, camera.tracks.at(common->tracks[i]));
  }
  localise_backwards(map, camera, set.id, config.localise);
  localise_backwards(map, camera, common->set, config.localise);
  // Two views leave depth and direction weakly known; the ones between settle it.
  constexpr std::uint32_t kSteps = 6;
  for (std::uint32_t i = 0; i <= kSteps; ++i) {
    map.add_key_frame(SetId(common->set.value + i * (set.id.value - common->set.value) / kSteps));
  }
  if (const auto job = plan_refine(map, id, true, config.refine)) {
    apply_refine(map, *job, solve_refine(*job));
  }
  put_to_the_proof(map, id);
  map.raise_epoch();
  ++report->started;
}

// Points of one map that carry descriptors.
struct DescribedPoints {
  std::vector<PointId> ids;
  std::vector<std::uint8_t> descriptors;
};

DescribedPoints described_points(const Map& map, MapId of) {
  DescribedPoints out;
  for (const auto& [id, p] : map.points()) {
    if (p.map != of || p.state != PointState::kStatic || p.descriptor.empty()) continue;
    out.ids.push_back(id);
    out.descriptors.insert(out.descriptors.end(), p.descriptor.begin(), p.descriptor.end());
  }
  return out;
}

struct Located {
  Rigid3 cam_from_world;  // in the other map
  std::vector<std::pair<TrackId, PointId>> matches;
};

std::optional<Located> locate(const Map& map, const MapCamera& camera, const TrackFeatures& features, MapId in,
                              int min_inliers) {
  const DescribedPoints points = described_points(map, in);
  const auto matches = match_descriptors(features.image.descriptors, points.descriptors);
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector2d> pixels;
  for (const FeatureMatch& m : matches) {
    positions.push_back(map.find(points.ids[static_cast<std::size_t>(m.second)])->position);
    pixels.push_back(features.image.undistorted_px[static_cast<std::size_t>(m.first)]);
  }
  const PlaceResult placed = place_camera(camera.model, positions, pixels, 1.5, min_inliers);
  if (!placed.ok) return std::nullopt;
  std::vector<Eigen::Vector2d> spread;
  Located out{placed.cam_from_world, {}};
  for (const int i : placed.inliers) {
    const FeatureMatch& m = matches[static_cast<std::size_t>(i)];
    out.matches.emplace_back(features.tracks[static_cast<std::size_t>(m.first)],
                             points.ids[static_cast<std::size_t>(m.second)]);
    spread.push_back(pixels[static_cast<std::size_t>(i)]);
  }
  // A handful of matches on one object does not fix a pose.
  if (hull_fraction(spread, camera.model) < 0.08) return std::nullopt;
  return out;
}

void place(Map& map, MapCamera& camera, const Located& at, MapId in, const FrameSet& set,
           const StartStageConfig& config) {
  set_pose(camera, set.id, in, at.cam_from_world);
  for (const auto& [track_id, point_id] : at.matches) {
    ServerTrack& t = camera.tracks.at(track_id);
    if (t.point == PointId()) map.bind(*map.find(point_id), camera.id, t);
  }
  localise_backwards(map, camera, set.id, config.localise);
  map.raise_epoch();
}

// in_from_own from the camera's pose in both maps; the scale from the depths of the matched tracks' points in both.
std::optional<Similarity3> map_similarity(const Map& map, const MapCamera& camera, const Located& at) {
  const Rigid3& own = camera.frames.back().cam_from_world;
  std::vector<double> ratios;
  for (const auto& [track_id, point_id] : at.matches) {
    const MapPoint* mine = map.find(camera.tracks.at(track_id).point);
    if (mine == nullptr) continue;
    const double own_depth = (own * mine->position).z(),
                 other_depth = (at.cam_from_world * map.find(point_id)->position).z();
    if (own_depth > 0 && other_depth > 0) ratios.push_back(std::log(other_depth / own_depth));
  }
  if (ratios.size() < 10) return std::nullopt;
  std::sort(ratios.begin(), ratios.end());
  const double middle = ratios[ratios.size() / 2];
  if (ratios[ratios.size() * 3 / 4] - ratios[ratios.size() / 4] > 0.3) return std::nullopt;  // they do not agree
  Similarity3 s;
  s.scale = std::exp(middle);
  s.rotation = (at.cam_from_world.rotation.conjugate() * own.rotation).normalized();
  s.translation = at.cam_from_world.center() - s.scale * (s.rotation * own.center());
  return s;
}

int frames_in(const Map& map, MapId id) {
  int n = 0;
  for (const MapCamera& c : map.cameras()) {
    n += static_cast<int>(
        std::count_if(c.frames.begin(), c.frames.end(), [&](const FramePose& f) { return f.map == id; }));
  }
  return n;
}

void merge_maps(Map& map, MapCamera& camera, const Located& at, MapId in, const Similarity3& in_from_own) {
  const MapId own = camera.map;
  // The larger map keeps its frame; the older one when they are equal.
  if (frames_in(map, own) > frames_in(map, in) || (frames_in(map, own) == frames_in(map, in) && own < in)) {
    map.merge(in, own, in_from_own.inverse());
  } else {
    map.merge(own, in, in_from_own);
  }
  for (const auto& [track_id, point_id] : at.matches) {
    ServerTrack& t = camera.tracks.at(track_id);
    MapPoint* kept = map.find(point_id);
    if (kept == nullptr) continue;
    if (t.point == PointId()) {
      map.bind(*kept, camera.id, t);
    } else if (t.point != point_id) {
      map.fuse(point_id, t.point);
      retriangulate(map, *kept);
    }
  }
}

void place_and_merge(Map& map, const FrameSet& set, const StartStageConfig& config, StartReport* report) {
  for (const CameraFrame& cf : set.frames) {
    if (!cf.descriptors) continue;
    MapCamera& camera = map.camera(cf.camera);
    const TrackFeatures features = features_of(map, cf);
    std::vector<MapId> maps;
    for (const auto& [id, p] : map.points()) {
      if (std::find(maps.begin(), maps.end(), p.map) == maps.end()) maps.push_back(p.map);
    }
    for (const MapId other : maps) {
      if (other == camera.map) continue;
      const bool unplaced = camera.map == MapId();
      if (!unplaced && !camera.frames.back().valid()) break;
      const auto at =
          locate(map, camera, features, other, unplaced ? config.min_place_inliers : config.min_merge_inliers);
      if (!at) continue;
      if (unplaced) {
        place(map, camera, *at, other, set, config);
        ++report->placed;
      } else if (const auto similarity = map_similarity(map, camera, *at)) {
        merge_maps(map, camera, *at, other, *similarity);
        ++report->merged;
        report->merged_into = camera.map;
      } else {
        continue;
      }
      break;
    }
  }
}

bool something_to_place(const Map& map) {
  MapId seen;
  for (const MapCamera& c : map.cameras()) {
    if (!c.alive || c.frames.empty()) continue;
    if (c.map == MapId()) return true;
    if (seen != MapId() && c.map != seen) return true;
    seen = c.map;
  }
  return false;
}

}  // namespace

StartReport start(Map& map, const FrameSet& set, const StartStageConfig& config) {
  StartReport report;
  take_descriptors(map, set);
  start_together(map, set, config, &report);
  place_and_merge(map, set, config, &report);
  for (const CameraFrame& cf : set.frames) {
    MapCamera& camera = map.camera(cf.camera);
    if (camera.map == MapId() && sets_without_map(camera) > config.alone_after_sets && set.id.value % 3 == 0) {
      start_alone(map, camera, set, config, &report);
    }
  }
  report.wants_descriptors =
      something_to_place(map) && set.id.value % static_cast<std::uint32_t>(config.request_period) == 0;
  return report;
}

}  // namespace coslam
