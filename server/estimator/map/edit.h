// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <utility>

#include "server/estimator/map/journal.h"
#include "server/estimator/map/map.h"
#include "server/estimator/map/map_rows.h"
#include "server/estimator/map/renumber.h"

namespace coslam {

// The logarithm of how much longer the focal length of an image is than its camera's lens says.
struct FrameZoom {
  SetId set;
  double log_zoom = 0;
};

// The only way to write the map. Every change of its structure says why, and is noted in the journal with the figures
// that decided; new estimates of what stays are not. Keeps the map's invariants: a track and its point name each other,
// key observations are sorted and unique, the indices behind Map's queries hold. Entities are named by references to
// the map's own, as Map gives them out. Thread-compatible.
class MapEdit {
 public:
  explicit MapEdit(const MapConfig& config) : map_(config) {}

  const Map& map() const { return map_; }
  Journal& journal() { return journal_; }
  const Journal& journal() const { return journal_; }

  // ---- cameras ----
  CameraId add_camera(const std::string& name, RunId run, const CameraModel& model);
  // An agent that restarted: its old tracks are gone, its poses stay.
  void restart_camera(CameraId id, RunId run, const CameraModel& model);
  // What is wrong about its calibration, as far as it is known now: all that it saw is where the new lens has it.
  void correct_lens(const MapCamera& camera, const LensCorrection& lens, const LensCorrection::Values& sigma);
  // Its focal length changes from image to image.
  void note_breathing(const MapCamera& camera, double most) {
    own(camera).breathing = std::max(camera.breathing, most);
  }
  // All that a camera saw comes to where it would be without zooms, which go evenly from one of these (ascending) to
  // the next.
  void leave_zoom_out(const MapCamera& camera, std::span<const FrameZoom> zooms);
  void set_alive(CameraId id, bool alive) { own(id).alive = alive; }
  // Standard deviation of its observations in one more frame: a running mean, faster at the beginning.
  void measure_sigma(const MapCamera& camera, double sigma_px);
  // The same from elsewhere, as if from many frames.
  void set_sigma(const MapCamera& camera, double sigma_px) { own(camera).sigma_px = sigma_px; }
  void set_sparse(const MapCamera& camera, bool sparse) { own(camera).sparse = sparse; }
  // Its images were taken so much later than they are dated, against another camera's: only told.
  void note_misdated(const MapCamera& camera, double lag_s, CameraId against) {
    note_camera(EventKind::kCameraMisdated, camera, Why::kMovesAtOtherTimes,
                {lag_s, static_cast<double>(against.value)});
  }
  void set_clock_offset(const MapCamera& camera, TimeNs offset_ns) { own(camera).clock_offset_ns = offset_ns; }
  // Its agent was told how its world moved and of which map it is part.
  void agent_was_told(const MapCamera& camera);

  // ---- poses ----
  void set_scene_depth(const MapCamera& camera, double depth) { own(camera).scene_depth = depth; }
  // Puts a camera into a map, at its newest or an earlier set.
  void place(const MapCamera& camera, SetId set, MapId map, const Rigid3& cam_from_world, Why why,
             Figures figures = {});
  // Its pose at a set, in the map that it is in.
  void set_pose(const MapCamera& camera, SetId set, const Rigid3& cam_from_world);
  // Its newest one, as its agent says, which has points that the map has not.
  void take_word(const MapCamera& camera, const Rigid3& cam_from_world);
  // The newest pose rests on more than its agent has: it is to take it.
  void tell_pose(const MapCamera& camera) { own(camera).corrected = true; }
  // Its newest one, found together with the other cameras of its group; rests_on_moving: the static points alone would
  // not hold it.
  void set_joint_pose(const MapCamera& camera, const Rigid3& cam_from_world, bool rests_on_moving);
  // The newest frame has no pose, with so many points known and so many that agree. How many in succession.
  int lose_pose(const MapCamera& camera, std::size_t known, int agree);
  void leave_map(const MapCamera& camera);
  // Another estimate of an earlier pose.
  void adjust_pose(const MapCamera& camera, const FramePose& frame, const Rigid3& cam_from_world);
  // The same, also of a frame that had no pose.
  void place_past(const MapCamera& camera, const FramePose& frame, MapId map, const Rigid3& cam_from_world);
  // The camera's world moved, and its agent is to move along.
  void carry_agent(const MapCamera& camera, const Similarity3& new_from_old);

  // ---- tracks ----
  // Takes the tracks of a frame set: extends, starts and ends tracks. Poses are left invalid.
  void ingest(const FrameSet& set);
  // Binds a track to a point, with its observations at key frames so far and its patch.
  void bind(const MapPoint& to, CameraId camera, const ServerTrack& of, Why why, Figures figures = {});
  // The same for a moving point, which lies offset_px from the track in the image. Its views so far say nothing about
  // where it is now.
  void bind_moving(const MapPoint& point, CameraId camera, const ServerTrack& track, const Eigen::Vector2f& offset_px,
                   Why why, Figures figures = {});
  void unbind(CameraId camera, const ServerTrack& of, Why why, Figures figures = {});
  // What was seen before this set is not used any more.
  void distrust_before(const ServerTrack& track, SetId set) { own(track).distrusted_before = set.value; }
  // Gate failures in succession, this one included; sigmas: how far outside, NaN behind the camera.
  int miss_gate(CameraId camera, const ServerTrack& track, double sigmas);
  void pass_gate(const ServerTrack& track) { own(track).gate_failures = 0; }
  // figures: of the tracks around it, how many move and how many rest.
  void set_motion(CameraId camera, const ServerTrack& track, TrackMotion motion, Figures figures = {});
  // What moves now went along with its camera before, since then.
  void went_along(const ServerTrack& track, SetId since) { own(track).went_along_since = since; }
  // Mapping it is not tried before that set.
  void map_not_before(const ServerTrack& track, SetId set) { own(track).mapping_after = set.value; }

  // ---- points ----
  MapId new_map(Why why, double figure);
  // Now.
  const MapPoint& create_point(MapId map, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance,
                               PointPhase phase, Why why, Figures figures = {});
  void remove_point(const MapPoint& point, Why why, Figures figures = {});
  // Another estimate; without a covariance, with that of its views from there.
  void move_point(const MapPoint& point, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance);
  void move_point(const MapPoint& point, const Eigen::Vector3d& position);
  void transform_point(const MapPoint& point, const Similarity3& new_from_old);
  // Its observations so far are of a place that it left.
  void forget_past(const MapPoint& of);
  // A track of it was inside the gate.
  void see(const MapPoint& of);
  // It is in use, whether or not it was seen.
  void keep_recent(const MapPoint& point);
  // Where a moving point is now, by views of this instant.
  void follow(const MapPoint& point, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance);
  // The direction from which the filter saw it last.
  void note_ray(const MapPoint& of, CameraId camera, const Eigen::Vector3d& ray_in_world);
  void prove(const MapPoint& point);
  // All static points of a map have to stand still for a while before anything rests on them.
  void put_on_trial(MapId map, Why why);
  // All that it was seen at is of a place that it left.
  void start_moving(const MapPoint& point, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance, Why why,
                    Figures figures = {});
  // It stood in the last `frames` of its tracks, which alone still count. It may go on, so it is on trial.
  void stop_moving(const MapPoint& of, int frames);
  // The track's patch becomes one of the point's.
  void give_patch(const MapPoint& point, CameraId camera, const ServerTrack& track);
  // Only the newest stay.
  void keep_newest_patches(const MapPoint& point, std::size_t most);
  // Of all points that were given one: the first and the newest stay, which come from the most different places.
  void thin_patches(std::size_t most);
  // It was followed again, or is worth keeping without.
  void is_not_loose(PointId point) { map_.loose_.erase(point); }
  void drop_observation(const MapPoint& point, SetId set, CameraId camera, TrackId track);
  // `gone` is the same thing as `kept`: its tracks and observations move over.
  void fuse(PointId kept, PointId gone, Why why, Figures figures = {});
  // Observations of this instant become part of a moving point's path.
  void record_motion(PointId point, MotionSample sample) { map_.motions_[point].push_back(std::move(sample)); }

  // ---- the past ----
  // What was observed in an image that is not newer is kept no more; a key frame of which nothing is kept is none any
  // more.
  void forget_view(SetId set, CameraId camera);
  // Of its patches those go whose image has no frame any more, but for the first, which tells its grey.
  void forget_patches(const MapPoint& point);
  // Tracks forget where they were seen before that set.
  void forget_seen(SetId before);
  // A camera's frames up to that set are past: gives out all of them that are not yet, without what they held. In
  // memory stay those that `stays` says.
  std::vector<FramePose> take_frames(const MapCamera& camera, SetId before, const std::set<SetId>& stays);
  // The frame that memory still holds of the past goes too.
  void forget_frame(const MapCamera& camera, SetId set);
  // The oldest part of the paths of moving points leaves memory.
  std::vector<std::pair<PointId, MotionSample>> take_motions(SetId before);

  // ---- the whole ----
  // An empty map becomes the one of these rows. Throws UserError when they contradict each other.
  void restore(const Tables& tables, int version = kRowsVersion) { MapRows::restore(tables, version, &map_); }
  // All maps of another one, with their points, frames and paths, beside those of this one; its cameras are new ones
  // here, under other names where theirs are taken, and see nothing any more.
  Renumbered take_in(const Map& other);
  // Nothing was seen for so many frame sets.
  void pass_sets(std::uint32_t sets) { map_.now_.value += sets; }
  // All times that are known are so much later than they were given.
  void shift_times(TimeNs by_ns);
  // Makes a set, now or earlier, a key frame: tracks bound now give their observations of it, but for those of cameras
  // that are spared. Nothing if it is one already.
  void add_key_frame(SetId set, const std::vector<CameraId>& spared = {});
  // One camera's image that is remembered by its looks: points keep their observations of it too.
  void add_key_image(SetId set, CameraId camera);
  // Cameras and points of `from` become part of `into`, moved by into_from_from. Every pose ever, too.
  void merge(MapId from, MapId into, const Similarity3& into_from_from);
  // Moves a whole map, e.g. to a known scale.
  void transform(MapId map, const Similarity3& new_from_old, Why why);
  // Lengths of that map are metres by now.
  void set_metric(MapId map) { map_.metric_.insert(map); }
  // Raises the epoch: the map moved under the agents.
  void raise_epoch() { ++map_.epoch_.value; }
  void note_moved(MapId map, Why why, Figures figures);

 private:
  // Everything given out by Map belongs to it, and is written here alone.
  MapCamera& own(CameraId id) { return map_.cameras_[id.value]; }
  MapCamera& own(const MapCamera& camera) { return own(camera.id); }
  static ServerTrack& own(const ServerTrack& track) { return const_cast<ServerTrack&>(track); }  // NOLINT: ours
  static MapPoint& own(const MapPoint& point) { return const_cast<MapPoint&>(point); }           // NOLINT: ours
  MapPoint* own(PointId id) { return map_.points_.by_id.find(id); }
  ServerTrack& own(const BoundTrack& b) { return own(b.camera).tracks.at(b.track); }

  Event event(EventKind kind, Why why, Figures figures = {}) const;
  void note_point(EventKind kind, const MapPoint& point, Why why, Figures figures = {});
  void note_track(EventKind kind, CameraId camera, const ServerTrack& track, Why why, Figures figures = {});
  void note_camera(EventKind kind, const MapCamera& camera, Why why, Figures figures = {});
  void set_phase(MapPoint& point, PointPhase phase, Why why, Figures figures = {});
  void touch(MapPoint& point);
  void observe(MapPoint& point, const KeyObservation& seen);
  // All places in images at which it saw something.
  void move_observations(MapCamera* camera, const std::function<void(Eigen::Vector2f*)>& move);
  // What it saw before is where the new one would have seen it.
  void change_model(MapCamera* camera, const CameraModel& model);
  void end_track(CameraId camera, ServerTrack& track, Why why);
  void let_go(CameraId camera, ServerTrack& track);
  void erase_point(PointId id);
  void move_map(MapId map, const Similarity3& new_from_old);
  MapCamera as_here(const MapCamera& other, const Renumbered& as) const;
  void take_in_points(const Map& other, const Renumbered& as);
  void take_tracks(MapCamera& c, const CameraFrame& cf, SetId set);

  Map map_;
  Journal journal_;
};

}  // namespace coslam
