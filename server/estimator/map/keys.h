// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

#include "server/estimator/map/session_pen.h"

// Write access to the map. Each stage of the pipeline has a key, which is the list of the verbs that it may call: a
// function that takes a CullEdit& can call those of CullEdit and no others. Narrow keys are for functions that several
// stages call. `coslam-server --stages` prints the keys of all stages.
namespace coslam {

// COSLAM_MAY(verb, ...) lets a key call these verbs; their names are in kMay.
#define COSLAM_PARENS ()
#define COSLAM_EXPAND(...) COSLAM_EXPAND3(COSLAM_EXPAND3(COSLAM_EXPAND3(COSLAM_EXPAND3(__VA_ARGS__))))
#define COSLAM_EXPAND3(...) COSLAM_EXPAND2(COSLAM_EXPAND2(COSLAM_EXPAND2(COSLAM_EXPAND2(__VA_ARGS__))))
#define COSLAM_EXPAND2(...) COSLAM_EXPAND1(COSLAM_EXPAND1(COSLAM_EXPAND1(COSLAM_EXPAND1(__VA_ARGS__))))
#define COSLAM_EXPAND1(...) __VA_ARGS__
#define COSLAM_EACH(does, ...) __VA_OPT__(COSLAM_EXPAND(COSLAM_EACH_NEXT(does, __VA_ARGS__)))
#define COSLAM_EACH_NEXT(does, first, ...) does(first) __VA_OPT__(COSLAM_EACH_AGAIN COSLAM_PARENS(does, __VA_ARGS__))
#define COSLAM_EACH_AGAIN() COSLAM_EACH_NEXT
#define COSLAM_USE(verb) using SessionPen::verb;
#define COSLAM_NAME(verb) std::string_view(#verb),
#define COSLAM_MAY(...)                \
  COSLAM_EACH(COSLAM_USE, __VA_ARGS__) \
  static constexpr std::array kMay { COSLAM_EACH(COSLAM_NAME, __VA_ARGS__) }

// Keys are assigned with the map whose keys they are (MapEdit), never one by one.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wvirtual-move-assign"
#endif

// Sets poses of frames in the map that their camera is in.
class FramePoseEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(set_pose);
};

// Gives poses to earlier frames that had none.
class LateFrameEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(place_past);
};

// Gives points other estimates.
class PointPositionEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(move_point);
};

// Adds to the paths of moving points.
class MovingPathEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(record_motion);
};

// Remembers images whose places are to be known again. Key of places/last_images.h.
class KeyImageEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(add_key_image);
};

// Applies the solution of a bundle adjustment.
class BundleEdit : public virtual PointPositionEdit {
 public:
  COSLAM_MAY(adjust_pose, carry_agent, correct_lens, drop_observation, leave_zoom_out, move_point, note_breathing,
             note_moved, raise_epoch, remove_point);
};

// Key of pose/localise.h.
class LocaliseEdit : public virtual FramePoseEdit {
 public:
  COSLAM_MAY(leave_map, lose_pose, measure_sigma, place, set_pose, set_scene_depth, set_sparse, accept_agent_pose);
};

// Key of pose/window_pose.h.
class WindowPoseEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(adjust_pose, push_pose_to_agent);
};

// Key of pose/wide_search.h.
class WideSearchEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(bind, keep_recent, set_pose, push_pose_to_agent);
};

// Key of pose/inter_pose.h.
class InterPoseEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(set_joint_pose);
};

// Key of create/start.h.
class StartEdit : public virtual FramePoseEdit, public virtual BundleEdit {
 public:
  COSLAM_MAY(add_key_frame, adjust_pose, bind, carry_agent, correct_lens, create_point, drop_observation,
             leave_zoom_out, move_point, new_map, note_breathing, note_moved, place, put_on_trial, raise_epoch,
             remove_point, set_metric, set_pose);
};

// Key of places/place_recognition.h.
class PlaceRecognitionEdit : public virtual FramePoseEdit,
                             public virtual PointPositionEdit,
                             public virtual KeyImageEdit {
 public:
  COSLAM_MAY(add_key_image, adjust_pose, bind, carry_agent, forget_view, fuse, keep_recent, merge, move_point,
             note_moved, place, raise_epoch, set_pose, transform_point);
};

// Key of associate/verify.h.
class VerifyEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(give_patch, miss_gate, move_point, note_ray, pass_gate, prove, see, set_sparse);
};

// Key of motion/classify.h.
class ClassifyEdit : public virtual MovingPathEdit {
 public:
  COSLAM_MAY(bind_moving, distrust_before, follow, forget_past, give_patch, keep_newest_patches, move_point, pass_gate,
             record_motion, remove_point, set_motion, start_moving, stop_moving, unbind, mark_co_moving);
};

// Key of motion/clock_offsets.h.
class ClockOffsetsEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(set_clock_offset);
};

// Key of motion/stamp_lag.h.
class StampLagEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(note_misdated);
};

// Key of associate/register.h.
class RegisterEdit : public virtual PointPositionEdit {
 public:
  COSLAM_MAY(bind, keep_recent, move_point);
};

// Key of create/map_intra.h.
class MapIntraEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(bind, create_point, map_not_before);
};

// Key of create/map_inter.h.
class MapInterEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(bind, create_point);
};

// Key of create/map_moving.h.
class MapMovingEdit : public virtual MovingPathEdit {
 public:
  COSLAM_MAY(bind_moving, create_point, fuse, record_motion);
};

// Key of associate/fuse.h.
class FuseEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(fuse, reposition_point);
};

// Key of associate/cull.h.
class CullEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(keep_untracked, remove_point, thin_patches);
};

// Key of adjust/scale.h.
class ScaleEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(set_metric, transform);
};

// Key of adjust/key_frames.h.
class KeyFramesEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(add_key_frame);
};

// Key of correct/correct.h.
class CorrectEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(mark_announced);
};

// Key of past/forget.h.
class ForgetEdit : public virtual LateFrameEdit {
 public:
  COSLAM_MAY(forget_frame, forget_patches, forget_seen, forget_view, place_past, remove_point, take_frames,
             take_motions);
};

// Key of the map server, which manages cameras and frame sets.
class SessionEdit : public virtual SessionPen {
 public:
  COSLAM_MAY(add_camera, ingest, pass_sets, restart_camera, restore, set_alive, shift_times, take_in);
};

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif

}  // namespace coslam
