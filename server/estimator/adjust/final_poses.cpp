// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/final_poses.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/geometry/pose_refinement.h"

namespace coslam {
namespace {

constexpr double kLeastAgree = 0.6;  // of the points
// Squared distance of the old pose in standard deviations of the new one, six degrees of freedom: a hundredth of a
// percent of right poses is so far off, were the old one as uncertain.
constexpr double kFarOff2 = 55;

// Which point each track of one camera showed: the one that it was last seen at.
using PointOfTrack = std::unordered_map<TrackId, const MapPoint*>;

class TrackedPoints {
 public:
  explicit TrackedPoints(std::size_t cameras) : points_(cameras), last_(cameras) {}
  void add(const MapPoint& p, const KeyObservation& o) {
    SetId& seen = last_[o.camera.value][o.track];
    if (seen > o.set) return;
    seen = o.set;
    points_[o.camera.value][o.track] = &p;
  }
  const PointOfTrack& points_of(CameraId camera) const { return points_[camera.value]; }

 private:
  std::vector<PointOfTrack> points_;
  std::vector<std::unordered_map<TrackId, SetId>> last_;
};

TrackedPoints tracked_points(const Map& map, MapId map_id) {
  TrackedPoints out(map.cameras().size());
  for (const auto& [id, p] : map.points()) {
    if (p.map != map_id || !p.proven()) continue;
    for (const KeyObservation& o : p.key_observations) out.add(p, o);
  }
  return out;
}

// By what is observed at the key frames of that time and around it.
TrackedPoints tracked_points(const Map& map, MapId map_id, CameraId camera, SetId from, SetId before) {
  constexpr double kAround_s = 10;  // few tracks live longer
  const std::uint32_t around = map.sets_in(kAround_s);
  std::vector<SetId> sets;
  for (const KeyFrame& k : map.key_frames()) {
    if (k.set.value + around >= from.value && k.set.value < before.value + around) sets.push_back(k.set);
  }
  TrackedPoints out(map.cameras().size());
  for (const MapPoint* p : map.points_observed_at(sets)) {
    if (p->map != map_id || !p->proven()) continue;
    for (const KeyObservation& o : p->key_observations) {
      if (o.camera == camera) out.add(*p, o);
    }
  }
  return out;
}

std::optional<PoseResult> solve(const Map& map, const CameraLens& camera, const PointOfTrack& points,
                                const FramePose& frame, const Rigid3& initial) {
  std::vector<PointObservation> seen;
  for (const HeldTrack& held : frame.held) {
    const auto at = points.find(held.track);
    if (at == points.end()) continue;
    seen.push_back({at->second->position, at->second->covariance, held.undistorted_px.cast<double>()});
  }
  if (std::ssize(seen) < kLeastInliers) return std::nullopt;
  PoseResult result = refine_pose(camera.model, seen, initial, {.sigma_px = map.sigma_bound_px(camera)});
  const bool good = result.status == PoseStatus::kOk && result.inliers >= kLeastInliers &&
                    result.inliers >= kLeastAgree * static_cast<double>(seen.size());
  return good ? std::optional(std::move(result)) : std::nullopt;
}

// Where a frame should be by the two beside it on one side, of which the first is the nearer.
Rigid3 predicted(const FramePose& beside, const FramePose* behind) {
  if (behind == nullptr || behind->map != beside.map) return beside.cam_from_world;
  return beside.cam_from_world * behind->cam_from_world.inverse() * beside.cam_from_world;
}

// Some frames of one camera, solved again by the points that their tracks showed.
class Settling {
 public:
  // first, last: index of its frames, one beyond the last.
  Settling(LateFrameEdit& edit, const MapCamera& camera, std::size_t first, std::size_t last, FinalPosesReport* report)
      : edit_(edit),
        camera_(camera),
        first_(static_cast<int>(first)),
        last_(static_cast<int>(last)),
        report_(*report) {}

  void run(const PointOfTrack& points, MapId map_id) {
    for (int i = first_; i < last_; ++i) {
      const FramePose& frame = *at(i);
      if (frame.map != map_id) continue;
      const auto result = solve(edit_.map(), camera_, points, frame, frame.cam_from_world);
      if (!result) continue;
      ++report_.solved;
      const Vector6d off = local(frame.cam_from_world, result->cam_from_world);
      if (off.dot(result->covariance.ldlt().solve(off)) < kFarOff2) continue;
      edit_.place_past(camera_, frame, map_id, result->cam_from_world);
      ++report_.changed;
    }
    for (const int step : {1, -1}) place_beside(points, map_id, step);
  }

 private:
  const FramePose* at(int i) const {
    const bool exists = i >= 0 && i < static_cast<int>(camera_.frames.size());
    return exists ? &camera_.frames[static_cast<std::size_t>(i)] : nullptr;
  }
  // One frame after the other from one that has a pose on, as far as the tracks lead. step: 1 forward, -1 backward.
  void place_beside(const PointOfTrack& points, MapId map_id, int step) {
    for (int k = first_; k < last_; ++k) {
      const int i = step > 0 ? k : first_ + last_ - 1 - k;
      const FramePose *here = at(i), *beside = at(i - step);
      if (here->valid() || beside == nullptr || beside->map != map_id) continue;
      const auto result = solve(edit_.map(), camera_, points, *here, predicted(*beside, at(i - 2 * step)));
      if (!result) continue;
      edit_.place_past(camera_, *here, map_id, result->cam_from_world);
      ++report_.placed;
    }
  }

  LateFrameEdit& edit_;
  const MapCamera& camera_;
  int first_, last_;
  FinalPosesReport& report_;
};

}  // namespace

FinalPosesReport refine_final_poses(LateFrameEdit& edit, MapId map_id) {
  FinalPosesReport report;
  const TrackedPoints points = tracked_points(edit.map(), map_id);
  for (const MapCamera& camera : edit.map().cameras()) {
    Settling(edit, camera, 0, camera.frames.size(), &report).run(points.points_of(camera.id), map_id);
  }
  return report;
}

FinalPosesReport refine_final_poses(LateFrameEdit& edit, const MapCamera& camera, SetId from, SetId before) {
  FinalPosesReport report;
  const auto index_of = [&](SetId set) {
    return static_cast<std::size_t>(std::ranges::lower_bound(camera.frames, set, {}, &FramePose::set) -
                                    camera.frames.begin());
  };
  const std::size_t first = index_of(from), last = index_of(before);
  std::set<MapId> maps;
  for (std::size_t i = first; i < last; ++i) {
    if (camera.frames[i].valid()) maps.insert(camera.frames[i].map);
  }
  for (const MapId map_id : maps) {
    const TrackedPoints points = tracked_points(edit.map(), map_id, camera.id, from, before);
    Settling(edit, camera, first, last, &report).run(points.points_of(camera.id), map_id);
  }
  return report;
}

}  // namespace coslam
