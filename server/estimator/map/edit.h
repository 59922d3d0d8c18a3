// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "server/estimator/map/keys.h"

namespace coslam {

// Map with all its keys: owned by the map server, which hands it to each stage as that stage's key. Every change of the
// map's structure has a reason, and is noted in the journal with the figures that decided; new estimates of existing
// entities are not. A value: a copy is independent of the original. Thread-compatible.
class MapEdit : public LocaliseEdit,
                public WindowPoseEdit,
                public WideSearchEdit,
                public InterPoseEdit,
                public StartEdit,
                public PlaceRecognitionEdit,
                public VerifyEdit,
                public ClassifyEdit,
                public ClockOffsetsEdit,
                public StampLagEdit,
                public RegisterEdit,
                public MapIntraEdit,
                public MapInterEdit,
                public MapMovingEdit,
                public FuseEdit,
                public CullEdit,
                public ScaleEdit,
                public KeyFramesEdit,
                public CorrectEdit,
                public ForgetEdit,
                public SessionEdit {
 public:
  explicit MapEdit(const MapConfig& config) : SessionPen(config) {}
  MapEdit(const MapEdit&) = default;
  MapEdit(MapEdit&&) = default;
  ~MapEdit() = default;
  // The map is assigned once, not once for each key, which would take it from each other.
  MapEdit& operator=(const MapEdit& other) {
    if (this != &other) SessionPen::operator=(other);
    return *this;
  }
  MapEdit& operator=(MapEdit&& other) noexcept {
    if (this != &other) SessionPen::operator=(std::move(other));
    return *this;
  }

  Journal& journal() { return journal_; }
  const Journal& journal() const { return journal_; }

  COSLAM_MAY(add_camera, add_key_frame, add_key_image, adjust_pose, mark_announced, bind, bind_moving, carry_agent,
             correct_lens, create_point, distrust_before, drop_observation, follow, forget_frame, forget_past,
             forget_patches, forget_seen, forget_view, fuse, give_patch, ingest, keep_untracked, keep_newest_patches,
             keep_recent, leave_map, leave_zoom_out, lose_pose, map_not_before, measure_sigma, merge, miss_gate,
             move_point, new_map, note_breathing, note_misdated, note_moved, note_ray, pass_gate, pass_sets, place,
             place_past, prove, put_on_trial, raise_epoch, record_motion, remove_point, reposition_point,
             restart_camera, restore, see, set_alive, set_clock_offset, set_joint_pose, set_metric, set_motion,
             set_pose, set_scene_depth, set_sparse, shift_times, start_moving, stop_moving, take_frames, take_in,
             take_motions, accept_agent_pose, push_pose_to_agent, thin_patches, transform, transform_point, unbind,
             mark_co_moving);
};

}  // namespace coslam
