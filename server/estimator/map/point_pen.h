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
  // Replaces the estimate of a point.
  void move_point(const MapPoint& point, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance);
  // Replaces the position of a point, and recomputes its covariance from its views there.
  void reposition_point(const MapPoint& point, const Eigen::Vector3d& position);
  void transform_point(const MapPoint& point, const Similarity3& new_from_old);
  // Drops the point's observations so far, which are of a place that it left.
  void forget_past(const MapPoint& map_point);
  // Notes that a track of the point was inside the gate.
  void see(const MapPoint& map_point);
  // Marks the point as in use, whether or not it was seen.
  void keep_recent(const MapPoint& point);
  // Sets the present position of a moving point, by views of this instant.
  void follow(const MapPoint& point, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance);
  // Notes the direction from which the filter saw the point last.
  void note_ray(const MapPoint& point, CameraId camera, const Eigen::Vector3d& ray_in_world);
  void prove(const MapPoint& point);
  // Puts all static points of a map on trial: they have to stand still for a while before anything rests on them.
  void put_on_trial(MapId map, Why why);
  // Makes a point moving: its earlier observations are of a place that it left.
  void start_moving(const MapPoint& point, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance, Why why,
                    Figures figures = {});
  // Puts a moving point on trial because it stood still in the last `frames` of its tracks, which alone still count; it
  // may move again.
  void stop_moving(const MapPoint& map_point, int frames);
  // Drops all but the newest patches of the point.
  void keep_newest_patches(const MapPoint& point, std::size_t most);
  // Thins the patches of all points that were given one: the first and the newest stay, which come from the most
  // different places.
  void thin_patches(std::size_t most);
  // Takes a point off the untracked ones: it was followed again, or is worth keeping without.
  void keep_untracked(PointId point) { map_.untracked_.erase(point); }
  void drop_observation(const MapPoint& point, SetId set, CameraId camera, TrackId track);
  // Fuses two points: the tracks and observations of `removed_id` move to `kept_id`.
  void fuse(PointId kept_id, PointId removed_id, Why why, Figures figures = {});
  // Appends observations of this instant to a moving point's path.
  void record_motion(PointId point, MotionSample sample) { map_.motions_[point].push_back(std::move(sample)); }

 private:
  void set_phase(MapPoint& point, PointPhase phase, Why why, Figures figures = {});
  void erase_point(PointId id);
};

}  // namespace coslam
