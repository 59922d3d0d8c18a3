// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>

#include "server/estimator/map/track_pen.h"

namespace coslam {

// Verbs on points.
class PointPen : public TrackPen {
 protected:
  using TrackPen::TrackPen;

  // Makes a point, seen now.
  const MapPoint& create_point(MapId map, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance,
                               PointPhase phase, Why why, Figures figures = {});
  void remove_point(const MapPoint& point, Why why, Figures figures = {});
  // Another estimate of a point.
  void move_point(const MapPoint& point, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance);
  // Another estimate of a point, with the covariance that its views give there.
  void reposition_point(const MapPoint& point, const Eigen::Vector3d& position);
  void transform_point(const MapPoint& point, const Similarity3& new_from_old);
  // The point's observations so far are of a place that it left.
  void forget_past(const MapPoint& of);
  // A track of the point was inside the gate.
  void see(const MapPoint& of);
  // The point is in use, whether or not it was seen.
  void keep_recent(const MapPoint& point);
  // Where a moving point is now, by views of this instant.
  void follow(const MapPoint& point, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance);
  // The direction from which the filter saw the point last.
  void note_ray(const MapPoint& of, CameraId camera, const Eigen::Vector3d& ray_in_world);
  void prove(const MapPoint& point);
  // All static points of a map have to stand still for a while before anything rests on them.
  void put_on_trial(MapId map, Why why);
  // The point moves: all that it was seen at is of a place that it left.
  void start_moving(const MapPoint& point, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance, Why why,
                    Figures figures = {});
  // The point stood still in the last `frames` of its tracks, which alone still count. It may go on, so it is on trial.
  void stop_moving(const MapPoint& of, int frames);
  // Only the newest patches of the point stay.
  void keep_newest_patches(const MapPoint& point, std::size_t most);
  // Of all points that were given a patch: the first and the newest stay, which come from the most different places.
  void thin_patches(std::size_t most);
  // The point was followed again, or is worth keeping without.
  void keep_untracked(PointId point) { map_.untracked_.erase(point); }
  void drop_observation(const MapPoint& point, SetId set, CameraId camera, TrackId track);
  // `gone` is the same thing as `kept`: its tracks and observations move over.
  void fuse(PointId kept, PointId gone, Why why, Figures figures = {});
  // Observations of this instant become part of a moving point's path.
  void record_motion(PointId point, MotionSample sample) { map_.motions_[point].push_back(std::move(sample)); }

 private:
  void set_phase(MapPoint& point, PointPhase phase, Why why, Figures figures = {});
  void erase_point(PointId id);
};

}  // namespace coslam
