// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "common/base/fields.h"
#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/geometry/pose_refinement.h"
#include "common/geometry/rigid3.h"
#include "common/geometry/triangulation.h"
#include "common/model/rig.h"
#include "server/estimator/map/camera.h"
#include "server/estimator/map/frame_set.h"
#include "server/estimator/map/point.h"
#include "server/estimator/map/point_table.h"
#include "server/estimator/map/track.h"

// Map and everything that was observed, owned by one thread. Any code may read it; it is written by verbs alone, which
// keep its invariants (server/estimator/map/keys.h).
namespace coslam {

// Identifies a camera's image.
using ImageKey = std::pair<SetId, CameraId>;

struct KeyFrame {
  SetId set;
};
auto fields(Like<KeyFrame> auto& k) { return std::tuple(kept("set", k.set)); }

// Transform of a whole map; if `into` is another map, `from` became part of that one.
struct MapMove {
  MapId from, into;
  Similarity3 into_from_from;
};
auto fields(Like<MapMove> auto& m) {
  return std::tuple(kept("from", m.from), kept("into", m.into), kept("into_from_from", m.into_from_from));
}

struct MapConfig {
  double sigma_px = kMostSigma_px;  // largest believed noise of detection and tracking, at 640 px image width
  double theta = 2.0;               // Mahalanobis gate
  // Factor on the measured noise behind point covariances. Residuals do not show what all views of a track share: its
  // drift on the surface, and the error of poses that moved with it. Measured on simulated truth, see
  // docs/lab/results.md (NEES).
  double covariance_sigma_factor = 2.6;
  double recent_s = 6.67;  // N_rec: a point is active when it was seen within this time
  // Least correlation at which two patches show one place, the same for all stages.
  double zncc_min = 0.7;
  double zncc_margin = 0.05;        // least difference of the best match to the second best
  double min_parallax_rad = 0.017;  // least parallax of a new point's views
  // N_min: time of a track over which a point has to fit before it is bound; points of younger ones are on trial.
  double check_back_s = 2.0;
  int failures = 3;     // successive gate failures of a track that count
  int few_points = 60;  // proven points below which a camera relies on others and on directions too
  double new_view_rad =
      kNewView_rad;               // rotation of a viewing ray after which one more view of a point adds information
  double match_period_s = 0.17;   // time between searches for tracks and points of one place, where nothing is urgent
  std::vector<std::string> rigs;  // cameras that are fixed to another: CAMERA FIRST x y z qx qy qz qw each
};

class Map {
 public:
  // Throws UserError for an invalid rig.
  explicit Map(const MapConfig& config);

  const MapConfig& config() const { return config_; }
  const std::vector<MapCamera>& cameras() const { return cameras_; }
  const MapCamera& camera(CameraId id) const { return cameras_[id.value]; }
  const ServerTrack& track(const BoundTrack& bound) const { return camera(bound.camera).tracks.at(bound.track); }
  const std::map<PointId, MapPoint>& points() const { return points_.all; }
  const MapPoint* find(PointId id) const { return points_.by_id.find(id); }
  const std::vector<KeyFrame>& key_frames() const { return key_frames_; }
  bool is_key_frame(SetId set) const;
  // Images of cameras that took no part in a key frame, as they saw nothing new.
  const std::set<ImageKey>& skipped_key_images() const { return skipped_key_images_; }

  // Returns the points that move now, sorted by id.
  std::vector<const MapPoint*> moving_points() const;
  // Paths of points that move or moved, also of removed ones.
  const std::map<PointId, std::vector<MotionSample>>& motions() const { return motions_; }
  // Returns the points seen lately, see is_recent(), sorted by id. Like all queries below, without a look at every
  // point.
  std::vector<const MapPoint*> recent_points() const;
  // Returns the points seen at this set or later, sorted by id.
  std::vector<const MapPoint*> points_seen_since(SetId set) const;
  // Returns the points with a key observation in one of these images; at one of these sets; at this set or later.
  // Sorted by id.
  std::vector<const MapPoint*> points_observed_in(const std::vector<ImageKey>& images) const;
  std::vector<const MapPoint*> points_observed_at(const std::vector<SetId>& sets) const;
  std::vector<const MapPoint*> points_observed_since(SetId set) const;
  // Points that no track follows, since their last binding ended; cull() checks these.
  const std::set<PointId>& untracked_points() const { return untracked_; }

  // Standard deviation of the gates: generous compared with the measured one, never above sigma_px of the
  // configuration.
  double gate_sigma_px(const CameraLens& camera) const;
  // Largest believed noise, in pixels of this camera.
  double sigma_bound_px(const CameraLens& camera) const { return camera.model.px_from_640(config_.sigma_px); }

  // Covariance (4) of a point from its first and last view of each track (the paper: two observations a camera), since
  // the views between them repeat the same errors. Uses key observations and the newest one of bound tracks.
  Eigen::Matrix3d covariance_of(const MapPoint& point) const { return covariance_of(point, point.position); }
  // Covariance (4) that a point would have at another position.
  Eigen::Matrix3d covariance_of(const MapPoint& point, const Eigen::Vector3d& position) const;
  // Covariance (4) of a point about to be made at this position from tracks of these cameras.
  Eigen::Matrix3d covariance_of(const Eigen::Vector3d& position,
                                const std::vector<std::pair<const MapCamera*, const ServerTrack*>>& tracks) const;
  double covariance_sigma_px(const CameraLens& camera) const {
    return config_.covariance_sigma_factor * camera.sigma_px;
  }

  // Views of a track at frames with a pose in the camera's map, at most `most`, spread evenly in time with both ends
  // kept.
  std::vector<View> views_of(const MapCamera& camera, const ServerTrack& track, std::size_t most) const;
  // Views of all key observations of a point whose frames have poses.
  std::vector<View> key_views_of(const MapPoint& point) const;

  // Transforms of whole maps so far, and by how much all times were shifted: for data that was archived before.
  const std::vector<MapMove>& moves() const { return moves_; }
  TimeNs shifted_ns() const { return shifted_ns_; }
  // True when observations of that image are kept.
  bool keeps_observations_of(SetId set, CameraId camera) const;
  const std::set<ImageKey>& key_images() const { return key_images_; }

  // True when lengths of that map are metres, so that cameras of a rig are where the rig has them.
  bool is_metric(MapId map) const { return metric_.contains(map); }
  // Returns the other cameras of its rig.
  std::vector<CameraId> rig_mates(const CameraIdentity& camera) const;

  MapId next_map() const { return MapId(next_map_); }  // next new map
  MapEpoch epoch() const { return epoch_; }
  SetId now() const { return now_; }
  TimeNs now_ns() const { return now_ns_; }
  // True for a set at most recent_s ago.
  bool is_recent(SetId set) const { return set.value + sets_in(config_.recent_s) >= now_.value; }
  // Number of frame sets in that time, by the newest ones; at least one.
  std::uint32_t sets_in(double time_s) const;
  double set_interval_s() const { return set_interval_s_; }
  // Returns the set that long ago, or the first.
  SetId set_ago(double time_s) const { return SetId(now_.value - std::min(now_.value, sets_in(time_s))); }
  // True when the camera's pose is determined by its rig, from the observations of all the rig's cameras.
  bool is_posed_by_rig(const MapCamera& camera) const { return !camera.rig.empty() && is_metric(camera.map); }
  // True at one set in each such period.
  bool every(double period_s) const { return now_.value % sets_in(period_s) == 0; }
  // Number of such periods so far.
  std::uint32_t round(double period_s) const { return now_.value / sets_in(period_s); }

 private:
  friend class MapPen;
  friend class TrackPen;
  friend class PointPen;
  friend class CameraPen;
  friend class LensPen;
  friend class MapsPen;
  friend class PastPen;
  friend class ImportPen;
  friend class SessionPen;
  friend class MapRows;
  void put(MapPoint point);  // inserts a point unchanged
  std::vector<const MapPoint*> found(std::vector<PointId> given) const;

  MapConfig config_;
  std::vector<RigCamera> rigs_;
  std::set<MapId> metric_;
  std::vector<MapCamera> cameras_;
  PointTable points_;
  std::map<PointId, std::vector<MotionSample>> motions_;
  std::vector<KeyFrame> key_frames_;
  std::set<ImageKey> key_images_, skipped_key_images_;
  std::set<PointId> untracked_;
  std::map<ImageKey, std::vector<PointId>>
      observed_in_;                 // points by image; also some whose observation was removed; unsorted, some twice
  std::vector<PointId> repatched_;  // points that were given a patch since they were thinned
  std::uint32_t next_point_ = 1;
  std::uint32_t next_map_ = 1;
  MapEpoch epoch_;
  SetId now_;
  TimeNs now_ns_ = 0;
  double set_interval_s_ = kUsualInterval_s;
  std::vector<TimeNs> set_times_ns_;  // times of the newest few sets
  std::vector<MapMove> moves_;
  TimeNs shifted_ns_ = 0;
};

}  // namespace coslam
