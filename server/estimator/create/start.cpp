// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/create/start.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/pose_refinement.h"
#include "common/geometry/robust.h"
#include "server/estimator/adjust/apply_refine.h"
#include "server/estimator/adjust/refine.h"
#include "server/estimator/associate/register.h"

namespace coslam {
namespace {

// Features of one camera at this set, in track order.
struct TrackFeatures {
  FeatureImage image;
  std::vector<TrackId> tracks;
};

TrackFeatures features_of(const MapCamera& camera, const DescriptorReply& described) {
  TrackFeatures out;
  out.image.camera = camera.model;
  out.image.rig = camera.rig;
  out.image.cam_from_rig = camera.cam_from_rig;
  for (std::size_t i = 0; i < described.tracks.size(); ++i) {
    const auto at = camera.tracks.find(described.tracks[i]);
    if (at == camera.tracks.end()) continue;
    out.tracks.push_back(at->first);
    out.image.undistorted_px.emplace_back(at->second.seen.back().undistorted_px.cast<double>());
    const auto begin = described.descriptors.begin() + static_cast<std::ptrdiff_t>(i * kDescriptorBytes);
    out.image.descriptors.insert(out.image.descriptors.end(), begin, begin + kDescriptorBytes);
  }
  return out;
}

const MapPoint& add_start_point(StartEdit& edit, MapId id, const Eigen::Vector3d& position,
                                const std::vector<View>& views) {
  return edit.create_point(id, position, triangulation_covariance(views, position, 1.5), PointPhase::kStatic,
                           Why::kStartOfMap, {static_cast<double>(views.size()), 0});
}

void add_points(StartEdit& edit, MapId id, const std::vector<CameraId>& cameras,
                const std::vector<TrackFeatures>& features, const StartResult& result) {
  const auto camera_of = [&](int image) -> const MapCamera& {
    return edit.map().camera(cameras[static_cast<std::size_t>(image)]);
  };
  for (const StartResult::Point& p : result.points) {
    std::vector<View> views;
    for (const auto& [image, feature] : p.seen) {
      const auto i = static_cast<std::size_t>(image), f = static_cast<std::size_t>(feature);
      views.push_back({&camera_of(image).model, *result.cam_from_world[i], features[i].image.undistorted_px[f]});
    }
    const MapPoint& point = add_start_point(edit, id, p.position, views);
    for (const auto& [image, feature] : p.seen) {
      const TrackId id_of = features[static_cast<std::size_t>(image)].tracks[static_cast<std::size_t>(feature)];
      const ServerTrack& track = camera_of(image).tracks.at(id_of);
      if (!track.bound()) edit.bind(point, camera_of(image).id, track, Why::kMadeFromIt);
    }
  }
}

// Two views leave depth and direction weakly known; the ones from the first of them to the last settle it.
void settle_between(StartEdit& edit, MapId id, SetId first, SetId last, const BundleAdjustmentConfig& refine) {
  constexpr std::uint32_t kSteps = 6;
  if (first == last) return;
  const std::uint32_t steps = std::min(kSteps, last.value - first.value);
  for (std::uint32_t i = 0; i <= steps; ++i) {
    edit.add_key_frame(SetId(first.value + i * (last.value - first.value) / steps));
  }
  BundleAdjustmentConfig by_known_lenses = refine;
  by_known_lenses.lens = "given";
  if (const auto job = plan_refine(edit.map(), id, RefineExtent::kWhole, by_known_lenses)) {
    apply_refine(edit, *job, solve_refine(*job));
  }
}

SetId first_in_map(const MapCamera& camera) {
  return std::ranges::find(camera.frames, camera.map, &FramePose::map)->set;
}

double way_since(const MapCamera& camera, SetId start_set) {
  const FramePose* f = camera.frame_at(start_set);
  if (f == nullptr || f->map != camera.map) return 0;
  return (camera.frames.back().cam_from_world.center() - f->cam_from_world.center()).norm();
}

// These cameras, none of which has a map, at once.
void start_together(StartEdit& edit, const FrameSet& set, const std::vector<CameraId>& cameras,
                    const std::vector<TrackFeatures>& features, const StartStageConfig& config,
                    const LocaliseConfig& localise, const BundleAdjustmentConfig& refine, Workers& workers,
                    StartReport* report) {
  const Map& map = edit.map();
  std::vector<FeatureImage> images;
  images.reserve(features.size());
  for (const TrackFeatures& f : features) images.push_back(f.image);
  const StartResult result = start_map(images, config.pair, workers);
  if (!result.ok) {
    report->reason = result.reason;
    return;
  }
  const auto together = static_cast<double>(cameras.size());
  const MapId id = edit.new_map(Why::kStartedTogether, together);
  if (result.metric) edit.set_metric(id);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (!result.cam_from_world[i]) continue;
    edit.place(map.camera(cameras[i]), set.id, id, *result.cam_from_world[i], Why::kStartedTogether, {together, 0});
  }
  add_points(edit, id, cameras, features, result);
  edit.add_key_frame(set.id);
  SetId oldest = set.id;
  for (const CameraId c : cameras) {
    if (map.camera(c).map != id) continue;
    localise_backwards(edit, map.camera(c), set.id, localise);
    oldest = std::min(oldest, first_in_map(map.camera(c)));
  }
  // Side by side, a turn and a way look much alike. Cameras that have gone farther than they stand apart tell more.
  constexpr double kOfApart = 0.5;  // which is 1
  const auto goes = [&](CameraId c) { return map.camera(c).map == id && way_since(map.camera(c), oldest) > kOfApart; };
  if (!result.metric && std::ranges::any_of(cameras, goes)) settle_between(edit, id, oldest, set.id, refine);
  edit.put_on_trial(id, Why::kMapIsNew);
  edit.raise_epoch();
  ++report->started;
}

// Tracks that the camera has now and had at an earlier set.
struct Common {
  SetId set;
  std::vector<TrackId> tracks;
  FeatureImage before, now;
  std::vector<FeatureMatch> matches;
  double median_flow_px = 0;
};

Common common_tracks(const MapCamera& camera, SetId earlier_set) {
  Common c;
  c.set = earlier_set;
  c.before.camera = c.now.camera = camera.model;
  std::vector<double> flow;
  for (const auto& [id, t] : camera.tracks) {
    const auto at = t.index_at(earlier_set);
    if (!at) continue;
    const int i = static_cast<int>(c.tracks.size());
    c.tracks.push_back(id);
    c.before.undistorted_px.emplace_back(t.seen[*at].undistorted_px.cast<double>());
    c.now.undistorted_px.emplace_back(t.seen.back().undistorted_px.cast<double>());
    c.matches.push_back({i, i, 0});
    flow.push_back((c.before.undistorted_px.back() - c.now.undistorted_px.back()).norm());
  }
  c.median_flow_px = upper_median(flow);
  return c;
}

// The oldest set of which enough tracks are left.
std::optional<Common> widest_common(const MapCamera& camera, int min_matches) {
  // Half of them have to be inliers.
  const std::size_t enough =
      std::max<std::size_t>(2 * static_cast<std::size_t>(min_matches), camera.tracks.size() * 2 / 5);
  if (camera.tracks.size() < enough) return std::nullopt;
  std::vector<SetId> begins;
  for (const auto& [id, t] : camera.tracks) begins.push_back(t.seen.front().set);
  std::sort(begins.begin(), begins.end());
  const auto first = std::lower_bound(camera.frames.begin(), camera.frames.end(), begins[enough - 1],
                                      [](const FramePose& f, SetId set) { return f.set < set; });
  const auto oldest = std::find_if(first, camera.frames.end(), [](const FramePose& f) { return !f.valid(); });
  if (oldest == camera.frames.end() || oldest->set == camera.frames.back().set) return std::nullopt;
  return common_tracks(camera, oldest->set);
}

// Its newest frames are without a pose, for so long: by their number, and by their times, since at the beginning, with
// gaps, how often they come is hardly known.
bool without_map_for(const CameraFrames& camera, double wait_s) {
  const auto posed =
      std::find_if(camera.frames.rbegin(), camera.frames.rend(), [](const auto& f) { return f.valid(); });
  const auto first = posed.base();
  if (camera.frames.end() - first <= camera.frames_in(wait_s)) return false;
  return to_seconds(camera.frames.back().capture_ns - first->capture_ns) >= wait_s - 0.5 * camera.frame_interval_s;
}

// Two views of one camera at different times.
void start_alone(StartEdit& edit, const MapCamera& camera, const FrameSet& set, const StartStageConfig& config,
                 const LocaliseConfig& localise, const BundleAdjustmentConfig& refine, StartReport* report) {
  const std::optional<Common> common = widest_common(camera, config.pair.min_matches);
  if (!common || common->median_flow_px < camera.model.px_from_640(config.min_flow_px)) return;
  const StartResult result = start_from_matches(common->before, common->now, common->matches, config.pair);
  if (!result.ok) {
    report->reason = result.reason;
    return;
  }
  const double over = set.id.value - common->set.value;
  const MapId id = edit.new_map(Why::kStartedAlone, over);
  edit.place(camera, common->set, id, *result.cam_from_world[0], Why::kStartedAlone, {over, 0});
  edit.set_pose(camera, set.id, *result.cam_from_world[1]);
  for (const StartResult::Point& p : result.points) {
    const auto i = static_cast<std::size_t>(p.seen.front().second);
    const std::vector<View> views{{&camera.model, *result.cam_from_world[0], common->before.undistorted_px[i]},
                                  {&camera.model, *result.cam_from_world[1], common->now.undistorted_px[i]}};
    edit.bind(add_start_point(edit, id, p.position, views), camera.id, camera.tracks.at(common->tracks[i]),
              Why::kMadeFromIt);
  }
  localise_backwards(edit, camera, set.id, localise);
  localise_backwards(edit, camera, common->set, localise);
  settle_between(edit, id, common->set, set.id, refine);
  edit.put_on_trial(id, Why::kMapIsNew);
  edit.raise_epoch();
  ++report->started;
}

}  // namespace

void Start::remember(const Map& map, const FrameSet& set) {
  std::erase_if(described_, [&](const auto& d) {
    const MapCamera& camera = map.camera(d.first);
    return !camera.alive || camera.map != MapId() || d.second.agent_run != camera.run;  // tracks are of a run
  });
  for (const CameraFrame& cf : set.frames) {
    if (map.camera(cf.camera).map != MapId() || !cf.descriptors) continue;
    described_[cf.camera] = *cf.descriptors;
    if (!waiting_since_) waiting_since_ = set.id;
  }
}

Start::Unplaced Start::unplaced(const Map& map, const FrameSet& set) const {
  const auto free = [](const MapCamera& c) { return c.alive && c.map == MapId(); };
  Unplaced out{.cameras = static_cast<int>(std::ranges::count_if(map.cameras(), free))};
  for (const CameraFrame& cf : set.frames) {
    if (free(map.camera(cf.camera)) && described_.contains(cf.camera)) out.described.push_back(cf.camera);
  }
  return out;
}

// Not before all had the time to answer.
bool Start::together_now(const Map& map, const Unplaced& cameras) {
  constexpr double kPatience_s = 1;
  if (!waiting_since_) return false;
  if (cameras.some_silent() && map.now().value < waiting_since_->value + map.sets_in(kPatience_s)) return false;
  waiting_since_.reset();
  return cameras.described.size() >= 2;
}

StartReport Start::run(StartEdit& edit, const FrameSet& set, const LocaliseConfig& localise,
                       const BundleAdjustmentConfig& refine, Workers& workers) {
  constexpr double kTry_s = 0.1;
  constexpr double kTogetherFirst = 8;  // times as long
  StartReport report;
  const Map& map = edit.map();
  remember(map, set);
  const Unplaced cameras = unplaced(map, set);
  if (together_now(map, cameras)) {
    std::vector<TrackFeatures> features;
    for (const CameraId c : cameras.described) features.push_back(features_of(map.camera(c), described_.at(c)));
    start_together(edit, set, cameras.described, features, config, localise, refine, workers, &report);
    const auto answers = std::ranges::count_if(set.frames, [&](const CameraFrame& cf) {
      return cf.descriptors && std::ranges::find(cameras.described, cf.camera) != cameras.described.end();
    });
    const auto left_over = [&](CameraId c) { return map.camera(c).map == MapId(); };
    may_yet_start_ = answers < std::ssize(cameras.described) && std::ranges::any_of(cameras.described, left_over);
  }
  for (const CameraFrame& cf : set.frames) {
    const MapCamera& camera = map.camera(cf.camera);
    // Cameras of a rig first try together: they know lengths. So do those that may be about to start one map.
    const bool together_first = !map.rig_mates(camera).empty() || cameras.some_silent() || may_yet_start_;
    const double wait_s = config.alone_after_s * (together_first ? kTogetherFirst : 1);
    if (camera.map == MapId() && without_map_for(camera, wait_s) && map.every(kTry_s)) {
      start_alone(edit, camera, set, config, localise, refine, &report);
    }
  }
  return report;
}

}  // namespace coslam
