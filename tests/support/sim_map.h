// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "server/estimator/map/edit.h"
#include "tests/support/sim_tracker.h"
#include "tests/support/sim_world.h"

namespace coslam::test {

// Between frame sets: 30 a second.
constexpr TimeNs kPeriodNs = 33'333'333;

// A server map for the tests of one stage: frame sets are ingested in order, poses and points are put in as truth has
// them, or a little off, and what the stage then does is compared with truth. Map coordinates are world coordinates.
// The cameras' measured noise is what localisation would have measured.
class SimMap {
 public:
  SimMap(const SimWorld& world, const std::vector<CameraPath>& paths, const TrackingConfig& tracking = {},
         const MapConfig& config = {});
  SimMap(const SimMap&) = delete;  // `map` is part of `edit`
  SimMap& operator=(const SimMap&) = delete;
  ~SimMap() = default;

  // From one set to the next; to be set before the first.
  TimeNs period_ns = kPeriodNs;

  // The next frame set, not yet in the map: a test may still change it. patches: every track brings its patch.
  FrameSet& look(bool patches = false, bool descriptors = false);
  // Takes it in. Poses stay unset.
  void take() { edit.ingest(set); }
  // Both.
  const FrameSet& ingest(bool patches = false, bool descriptors = false);
  // Puts cameras of the newest set into the map, at their true poses.
  void place_truly();
  void place_truly(CameraId camera);
  // At any other; into any other map.
  void place(CameraId camera, const Rigid3& cam_from_world) { place(camera, id, cam_from_world); }
  void place(CameraId camera, MapId in, const Rigid3& cam_from_world);
  // All, `sets` times.
  void advance(int sets = 1, bool patches = false);

  // A map point that nothing is bound to; the covariance is sigma_m^2 I.
  const MapPoint& create(const Eigen::Vector3d& position, double sigma_m = 0.01,
                         PointPhase phase = PointPhase::kStatic) {
    return create(id, position, sigma_m, phase);
  }
  const MapPoint& create(MapId in, const Eigen::Vector3d& position, double sigma_m = 0.01,
                         PointPhase phase = PointPhase::kStatic);
  void bind(const MapPoint& point, CameraId camera, const ServerTrack& track) {
    edit.bind(point, camera, track, Why::kMadeFromIt);
  }
  // A map point for a point of the world, `off_m` from its true place, bound to its live tracks in all placed cameras.
  const MapPoint& add_point(int world_point, double sigma_m = 0.01,
                            const Eigen::Vector3d& off_m = Eigen::Vector3d::Zero(),
                            PointPhase phase = PointPhase::kStatic);
  // All static points that some placed camera sees and that have none yet, each off by Gaussian noise of sigma_m.
  void add_points(double sigma_m = 0.01);
  // The same estimate so far beside.
  void shift(const MapPoint& point, const Eigen::Vector3d& by_m) {
    edit.move_point(point, point.position + by_m, point.covariance);
  }
  // It moves from now on, where it is.
  void set_moving(const MapPoint& point) {
    edit.start_moving(point, point.position, point.covariance, Why::kSeenElsewhere);
  }

  // What its tracks see of a moving point in the newest set becomes part of its path, as follow_moving() does it.
  void record_now(const MapPoint& point);

  // World point behind a track or behind the first binding or observation of a map point; -1 when there is none.
  int world_point(CameraId camera, TrackId track) const { return trackers[camera.value].point_of(track); }
  int world_point(const MapPoint& point) const;
  // Live track of a world point in a camera; null when it has none.
  const ServerTrack* track_of(CameraId camera, int world_point) const;
  // Every camera has one.
  bool all_follow(int world_point) const;
  // What a camera sees of a world point in `set`, to be changed before it is taken; null when it sees none.
  TrackObservation* seen(CameraId camera, int world_point);
  ImagePatch* patch_of(CameraId camera, int world_point);
  Rigid3 truth(CameraId camera, SetId at) const;

  const SimWorld& world;
  std::vector<SimTracker> trackers;  // one for each camera
  MapEdit edit;
  const Map& map;
  MapId id;
  FrameSet set;

 private:
  std::uint32_t next_set_ = 0;
  std::mt19937_64 random_{99};
};

// (x - truth)^T covariance^-1 (x - truth)
double nees(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance);
double median(std::vector<double> values);

}  // namespace coslam::test
