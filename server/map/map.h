// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/flat_map.h"
#include "common/base/id_table.h"
#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/geometry/camera_model.h"
#include "common/geometry/lens_correction.h"
#include "common/geometry/rigid3.h"
#include "common/geometry/triangulation.h"
#include "common/model/map_patch.h"
#include "common/model/rig.h"
#include "common/model/track_frame.h"
#include "server/map/states.h"

// The map and everything that was observed, owned by one thread. Everybody may read it; it is written through MapEdit
// (server/map/edit.h) alone, which keeps its invariants.
namespace coslam {

// A camera's image.
using ImageKey = std::pair<SetId, CameraId>;

// Between frames, while there is only one.
inline constexpr double kUsualInterval_s = 1.0 / 30;
// Frames below which a window of time tells nothing.
inline constexpr int kLeastFrames = 3;
// Between images, from which on few of them show the same.
inline constexpr double kSeldom_s = 0.4;
// Looks of a point that are kept.
inline constexpr std::size_t kPatchesOfPoint = 6;

struct TrackPoint {
  SetId set;
  Eigen::Vector2f undistorted_px;
};

// A feature track of one camera as the server knows it.
struct ServerTrack {
  TrackId id;
  PointId point;                   // 0 = unmapped
  std::vector<TrackPoint> seen;    // ascending sets, thinned when old
  std::optional<PatchGrey> patch;  // newest received
  SetId patch_set;
  std::uint32_t mapping_after = 0;      // set number before which mapping it is not tried again
  int gate_failures = 0;                // in succession
  std::uint32_t distrusted_before = 0;  // observations of earlier sets are not used (it slid or was mismatched)
  TrackMotion motion = TrackMotion::kResting;
  std::optional<SetId> went_along_since;  // it was found to move, and went along with its camera before, from then on
  // From the track to the point, while that moves: two cameras find different corners of one small structure.
  Eigen::Vector2f offset_px = Eigen::Vector2f::Zero();

  bool bound() const { return point != PointId(); }
  bool moves() const { return motion == TrackMotion::kMoving; }
  // May become part of the static map.
  bool free_and_resting() const { return !bound() && motion == TrackMotion::kResting; }
  // Index in `seen`; empty when it was not seen at that set.
  std::optional<std::size_t> index_at(SetId set) const;
};

// Where a camera saw a track in one image.
struct HeldTrack {
  TrackId track;
  Eigen::Vector2f undistorted_px;
};

// Where one camera was at one frame set.
struct FramePose {
  SetId set;
  FrameId frame;
  TimeNs capture_ns = 0;
  MapId map;  // whose frame the pose is in; 0 = no pose
  Rigid3 cam_from_world;
  bool joint = false;           // rests on moving points or on its agent's word too: the static ones would not hold it
  std::vector<HeldTrack> held;  // some tracks, spread over the image, to solve the pose again when all is known

  bool valid() const { return map != MapId(); }
  float zoom_taken_out = 0;  // of what it observed, see MapEdit::leave_zoom_out()
};

// Frames of a camera that memory holds no more, see server/map/past.h.
struct PastFramesCount {
  SetId until;  // those before it; some are in memory all the same, the others hang on them
  int frames = 0;
  std::map<MapId, int> placed;                  // frames with a pose, by the map they are in now
  TimeNs first_ns = 0;                          // capture of the first
  std::vector<std::pair<TimeNs, TimeNs>> lost;  // from when to when it had no pose
};

// A followed corner in one image.
struct Sighting {
  CameraId camera;
  Eigen::Vector2f undistorted_px;
  Eigen::Vector2f step_px = Eigen::Vector2f::Zero();  // since the image before; 0 where it began
};

// An epoch that an agent was told of, and how its world was moved since.
struct ToldEpoch {
  MapEpoch epoch;
  Similarity3 moved;
};

struct MapCamera {
  CameraId id;
  std::string name;
  RunId run;
  CameraModel model;     // as calibrated
  LensCorrection lens;   // what is wrong about that; all that was observed is undistorted with it
  double breathing = 0;  // by how much its focal length was found to change from image to image, most; 0: not known to
  LensCorrection::Values lens_sigma = LensCorrection::Values::Zero();  // of its values; 0: as calibrated
  double sigma_px = 1.0;       // measured standard deviation of its observations
  int sigma_frames = 0;        // that it was measured in
  std::string rig;             // name of the first camera of the rig that it is fixed to; empty: it is free
  Rigid3 cam_from_rig;         // metres
  MapId map;                   // that it is being localised in; 0 = not placed
  bool corrected = false;      // its pose in this set rests on more than its agent has: the agent is to take it
  double scene_depth = 0;      // median of what it saw with its newest good pose; 0: not known yet
  bool sparse = false;         // it sees so few proven points for long that it has to use the others too
  int lost_sets = 0;           // frame sets in succession without a pose, while it has a map
  Similarity3 moved;           // how its world was moved since the last patch to its agent
  std::deque<ToldEpoch> told;  // of its present map, the newest ones
  MapId merged_from;           // the map that it was in then and that became part of its present one; 0 = no merge
  bool alive = true;
  SetId run_since;                             // of the frames of this run of its agent
  TimeNs clock_offset_ns = 0;                  // its images were taken so much later than they are dated
  double frame_interval_s = kUsualInterval_s;  // median of its newest ones
  std::vector<FramePose> frames;               // ascending sets, the whole run but for what is past
  PastFramesCount past;
  FlatMap<TrackId, ServerTrack> tracks;  // live ones; pointers hold until the next frame set

  Eigen::Vector2d raw_px(const Eigen::Vector2d& undistorted_px) const {
    return lens.raw_from_undistorted(model, undistorted_px);
  }
  const FramePose* frame_at(SetId set) const;
  // How its world was moved since an epoch that its agent speaks of; empty when that is too long ago, or of another
  // map.
  std::optional<Similarity3> moved_since(MapEpoch epoch) const;
  // Those that are not past.
  std::span<const FramePose> present_frames() const;
  std::size_t frames_ever() const { return static_cast<std::size_t>(past.frames) + present_frames().size(); }
  // Of all frames ever, those with a pose in this map.
  int frames_in_map(MapId in) const;
  // How many of its frames come in that time, by the newest ones; at least so many.
  int frames_in(double time_s, int least = 1) const;
  // Its images are so seldom that few things are in more than three.
  bool seldom() const { return frame_interval_s >= kSeldom_s; }
  // Of a track, to go by it.
  int least_views() const { return seldom() ? 2 : kLeastFrames; }
  TimeNs taken_ns(const FramePose& frame) const { return frame.capture_ns + clock_offset_ns; }
  // Pose at an instant near that set, in between the frame there and the one before when the image was taken at another
  // time; empty without poses in one map.
  std::optional<Rigid3> pose_at(SetId set, TimeNs t_ns) const;
  // What it would have seen at that instant, pose and pixel, by what it saw at the set. Empty without a pose in `in`.
  std::optional<View> view_at(MapId in, SetId set, const Sighting& seen, TimeNs t_ns) const;
};

struct KeyObservation {
  SetId set;
  CameraId camera;
  TrackId track;
  Eigen::Vector2f undistorted_px;
};

struct PointPatch {  // NOLINT(cppcoreguidelines-pro-type-member-init): never without its pixels
  CameraId camera;
  SetId set;  // of the image it was cut from
  PatchGrey pixels;
  Eigen::Vector2f offset_px = Eigen::Vector2f::Zero();  // from the patch's centre to the point
};

struct BoundTrack {
  CameraId camera;
  TrackId track;
  friend bool operator==(const BoundTrack&, const BoundTrack&) = default;
};

struct MapPoint {
  PointId id;
  MapId map;
  PointPhase phase = PointPhase::kStatic;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  SetId created;
  SetId last_seen;
  TimeNs first_ns = 0;
  TimeNs last_ns = 0;
  std::vector<KeyObservation> key_observations;  // at key frames and key images, ascending (set, camera)
  std::vector<BoundTrack> bound;                 // live tracks
  std::vector<PointPatch> patches;               // from different directions, few
  std::uint32_t views = 0;                       // observations that were gated in, all frames
  std::vector<Eigen::Vector3d> updated_from;     // by camera, as far as needed: ray at the last Kalman update or 0

  bool moves() const { return phase == PointPhase::kMoving; }
  bool rests() const { return phase != PointPhase::kMoving; }  // static, or on trial for that
  bool proven() const { return phase == PointPhase::kStatic; }
};

// What agents and files are told of a point.
PointState told_state(PointPhase phase);

// What was seen of a moving point at one set; its position at the instant t_ns follows from the poses and the clocks,
// whenever these are corrected.
struct MotionSample {
  SetId set;
  TimeNs t_ns = 0;
  std::vector<Sighting> seen;
};

struct KeyFrame {
  SetId set;
};

// A map was moved as a whole; into another, of which it is part then.
struct MapMove {
  MapId from, into;
  Similarity3 into_from_from;
};

// Everything observed at one instant.
struct CameraFrame {
  CameraId camera;
  TrackFrame frame;
  std::optional<PatchReply> patches;
  std::optional<DescriptorReply> descriptors;
};

struct FrameSet {
  SetId id;
  TimeNs t_ns = 0;
  std::vector<CameraFrame> frames;  // ascending camera, at most one each
};

struct MapConfig {
  double sigma_px = 3.0;  // largest believed noise of detection and tracking, at 640 px image width
  double theta = 2.0;     // Mahalanobis gate
  // Noise behind point covariances over the residuals' own. Residuals do not show what all views of a track share: its
  // drift on the surface, and the error of poses that moved with it. Measured on simulated truth, see
  // docs/lab/results.md (NEES).
  double covariance_sigma_factor = 2.6;
  double recent_s = 6.67;  // N_rec: a point is active when it was seen so lately
  // One meaning everywhere: when two patches show one place, and what makes a point worth having.
  double zncc_min = 0.7;
  double zncc_margin = 0.05;        // of the best match over the second best
  double min_parallax_rad = 0.017;  // of a new point's views
  double check_back_s = 2.0;        // of a track, in which a point that is to be its has to fit
  int failures = 3;                 // gate failures in succession of a track that count
  int few_points = 60;              // a camera that sees fewer proven points relies on others and on directions too
  double new_view_rad = 0.02;       // turn of a viewing ray by which one more view of a point tells something
  double match_period_s = 0.17;     // between looks for tracks and points that are one, where nothing hurries
  std::vector<std::string> rigs;    // cameras that are fixed to another: CAMERA FIRST x y z qx qy qz qw each
};

class Map {
 public:
  // Throws UserError for a rig that is none.
  explicit Map(const MapConfig& config);
  Map(const Map& other);
  Map& operator=(const Map& other);
  Map(Map&&) = default;
  Map& operator=(Map&&) = default;
  ~Map() = default;

  const MapConfig& config() const { return config_; }
  const std::vector<MapCamera>& cameras() const { return cameras_; }
  const MapCamera& camera(CameraId id) const { return cameras_[id.value]; }
  const ServerTrack& track(const BoundTrack& bound) const { return camera(bound.camera).tracks.at(bound.track); }
  const std::map<PointId, MapPoint>& points() const { return points_; }
  const MapPoint* find(PointId id) const { return index_.find(id); }
  const std::vector<KeyFrame>& key_frames() const { return key_frames_; }
  bool is_key_frame(SetId set) const;
  // Cameras that took no part in a key frame, as they saw nothing new.
  const std::set<ImageKey>& spared_images() const { return spared_images_; }

  // Those that move now, ascending.
  std::vector<const MapPoint*> moving_points() const;
  // Paths of points that move or moved, also of those that are gone.
  const std::map<PointId, std::vector<MotionSample>>& motions() const { return motions_; }
  // What follows is found without looking at every point that ever was. All ascending.
  // Seen lately: is_recent().
  std::vector<const MapPoint*> recent_points() const;
  // Seen at this set or later.
  std::vector<const MapPoint*> points_seen_since(SetId set) const;
  // With a key observation in one of these images; at one of these sets; at this set or later.
  std::vector<const MapPoint*> points_observed_in(const std::vector<ImageKey>& images) const;
  std::vector<const MapPoint*> points_observed_at(const std::vector<SetId>& sets) const;
  std::vector<const MapPoint*> points_observed_since(SetId set) const;
  // That no track follows, since their last binding ended; cull() looks at these.
  const std::set<PointId>& loose_points() const { return loose_; }

  // Standard deviation behind the gates: generous against the measured one, never above sigma_px of the configuration.
  double gate_sigma_px(const MapCamera& camera) const;
  // The largest believed noise, in pixels of this camera.
  double sigma_bound_px(const MapCamera& camera) const { return config_.sigma_px * camera.model.width_px / 640.0; }

  // Covariance (4) of a point from its first and last view of each track (the paper: two observations a camera), since
  // the views between them repeat the same errors. Uses key observations and the newest one of bound tracks.
  Eigen::Matrix3d covariance_of(const MapPoint& point) const { return covariance_of(point, point.position); }
  // The same were it there.
  Eigen::Matrix3d covariance_of(const MapPoint& point, const Eigen::Vector3d& position) const;
  // The same for a point about to be made at this position from tracks of these cameras.
  Eigen::Matrix3d covariance_of(const Eigen::Vector3d& position,
                                const std::vector<std::pair<const MapCamera*, const ServerTrack*>>& tracks) const;
  double covariance_sigma_px(const MapCamera& camera) const {
    return config_.covariance_sigma_factor * camera.sigma_px;
  }

  // Views of a track at frames with a pose in the camera's map, at most `most`, spread evenly in time with both ends
  // kept.
  std::vector<View> views_of(const MapCamera& camera, const ServerTrack& track, std::size_t most) const;
  // Views of all key observations of a point whose frames have poses.
  std::vector<View> key_views_of(const MapPoint& point) const;

  // All that maps as wholes went through, and by how much all times were shifted: for what was put down before.
  const std::vector<MapMove>& moves() const { return moves_; }
  TimeNs shifted_ns() const { return shifted_ns_; }
  // Observations of that image are kept.
  bool keeps_observations_of(SetId set, CameraId camera) const;
  const std::set<ImageKey>& key_images() const { return key_images_; }

  // Lengths of that map are metres, so that cameras of a rig are where the rig has them.
  bool is_metric(MapId map) const { return metric_.contains(map); }
  // Other cameras of its rig.
  std::vector<CameraId> rig_mates(const MapCamera& camera) const;

  MapId next_map() const { return MapId(next_map_); }  // not given yet
  MapEpoch epoch() const { return epoch_; }
  SetId now() const { return now_; }
  TimeNs now_ns() const { return now_ns_; }
  // Not longer ago than recent_s.
  bool is_recent(SetId set) const { return set.value + sets_in(config_.recent_s) >= now_.value; }
  // How many frame sets come in that time, by the newest ones; at least one.
  std::uint32_t sets_in(double time_s) const;
  double set_interval_s() const { return set_interval_s_; }
  // The set so long ago, or the first.
  SetId set_ago(double time_s) const { return SetId(now_.value - std::min(now_.value, sets_in(time_s))); }
  // The camera's pose is that of its rig, which all its cameras tell together.
  bool is_posed_by_rig(const MapCamera& camera) const { return !camera.rig.empty() && is_metric(camera.map); }
  // True at one set in that time.
  bool every(double period_s) const { return now_.value % sets_in(period_s) == 0; }
  // How often it was.
  std::uint32_t round(double period_s) const { return now_.value / sets_in(period_s); }

 private:
  friend class MapEdit;
  friend class MapRows;
  std::vector<const MapPoint*> found(std::vector<PointId> given) const;

  MapConfig config_;
  std::vector<RigCamera> rigs_;
  std::set<MapId> metric_;
  std::vector<MapCamera> cameras_;
  std::map<PointId, MapPoint> points_;
  IdTable<PointId, MapPoint> index_;  // of points_
  std::map<PointId, std::vector<MotionSample>> motions_;
  std::vector<KeyFrame> key_frames_;
  std::set<ImageKey> key_images_, spared_images_;
  // Parts of points_, so that nobody has to look at all of them.
  std::map<PointId, MapPoint*> moving_;
  FlatMap<PointId, MapPoint*> recent_;  // and some that were seen longer ago
  std::set<PointId> loose_;
  std::map<ImageKey, std::vector<PointId>>
      observed_in_;                 // and some whose observation is gone; in any order, some twice
  std::vector<PointId> repatched_;  // that were given a patch since they were thinned
  std::uint32_t next_point_ = 1;
  std::uint32_t next_map_ = 1;
  MapEpoch epoch_;
  SetId now_;
  TimeNs now_ns_ = 0;
  double set_interval_s_ = kUsualInterval_s;
  std::vector<TimeNs> set_times_ns_;  // the newest few
  std::vector<MapMove> moves_;
  TimeNs shifted_ns_ = 0;
  std::uint32_t lens_changes_ = 0;
};

// A live track of the camera shows the point.
bool seen_by(const MapPoint& point, CameraId camera);
// Live tracks of one camera show both, so they are two things.
bool seen_at_once(const MapPoint& p, const MapPoint& q);

}  // namespace coslam
