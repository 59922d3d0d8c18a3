// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/stages/start.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/pose_refinement.h"
#include "common/geometry/robust.h"
#include "server/stages/refine.h"
#include "server/stages/register.h"

namespace coslam {
namespace {

// Features of one camera at this set, in track order.
struct TrackFeatures {
  FeatureImage image;
  std::vector<TrackId> tracks;
};

TrackFeatures features_of(const Map& map, const CameraFrame& cf) {
  TrackFeatures out;
  const MapCamera& camera = map.camera(cf.camera);
  out.image.camera = camera.model;
  if (!cf.descriptors) return out;
  for (std::size_t i = 0; i < cf.descriptors->tracks.size(); ++i) {
    const auto at = camera.tracks.find(cf.descriptors->tracks[i]);
    if (at == camera.tracks.end()) continue;
    out.tracks.push_back(at->first);
    out.image.undistorted_px.emplace_back(at->second.seen.back().undistorted_px.cast<double>());
    const auto begin = cf.descriptors->descriptors.begin() + static_cast<std::ptrdiff_t>(i * kDescriptorBytes);
    out.image.descriptors.insert(out.image.descriptors.end(), begin, begin + kDescriptorBytes);
  }
  return out;
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
  images.reserve(features.size());
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
    c.then.undistorted_px.emplace_back(at->undistorted_px.cast<double>());
    c.now.undistorted_px.emplace_back(t.seen.back().undistorted_px.cast<double>());
    c.matches.push_back({i, i, 0});
    flow.push_back((c.then.undistorted_px.back() - c.now.undistorted_px.back()).norm());
  }
  c.median_flow_px = upper_median(flow);
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
  if (const auto job = plan_refine(map, id, RefineExtent::kWhole, config.refine)) {
    apply_refine(map, *job, solve_refine(*job));
  }
  put_to_the_proof(map, id);
  map.raise_epoch();
  ++report->started;
}

}  // namespace

StartReport start(Map& map, const FrameSet& set, const StartStageConfig& config) {
  StartReport report;
  start_together(map, set, config, &report);
  for (const CameraFrame& cf : set.frames) {
    MapCamera& camera = map.camera(cf.camera);
    if (camera.map == MapId() && sets_without_map(camera) > config.alone_after_sets && set.id.value % 3 == 0) {
      start_alone(map, camera, set, config, &report);
    }
  }
  return report;
}

}  // namespace coslam
