// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/rigs.h"
#include "server/estimator/adjust/bundle_adjustment.h"
#include "server/estimator/adjust/key_frames.h"
#include "server/estimator/adjust/scale.h"
#include "server/estimator/associate/cull.h"
#include "server/estimator/associate/fuse.h"
#include "server/estimator/associate/register.h"
#include "server/estimator/associate/verify.h"
#include "server/estimator/correct/announce_moving.h"
#include "server/estimator/correct/correct.h"
#include "server/estimator/covisibility/expected_overlap.h"
#include "server/estimator/covisibility/grouping.h"
#include "server/estimator/create/map_inter.h"
#include "server/estimator/create/map_intra.h"
#include "server/estimator/create/map_moving.h"
#include "server/estimator/create/start.h"
#include "server/estimator/motion/classify.h"
#include "server/estimator/motion/clock_offsets.h"
#include "server/estimator/motion/objects.h"
#include "server/estimator/motion/stamp_lag.h"
#include "server/estimator/past/forget.h"
#include "server/estimator/pipeline/pipeline.h"
#include "server/estimator/places/descriptor_requests.h"
#include "server/estimator/places/last_images.h"
#include "server/estimator/places/place_recognition.h"
#include "server/estimator/pose/inter_pose.h"
#include "server/estimator/pose/localise.h"
#include "server/estimator/pose/wide_search.h"
#include "server/estimator/pose/window_pose.h"

namespace coslam {

// Stages of a frame set, in this order.
using MapPipeline = Pipeline<  //
    BundleAdjustment,          // applies the solution of the last bundle adjustment, which was planned by KeyFrames
    Localise,                  // intra-camera poses, from the points bound to each camera's tracks
    WindowPose,                // newest poses of cameras that see hardly any points, with all that they follow
    WideSearch,                // points that are seen again after a while, further from their prediction
    InterPose,                 // inter-camera poses of a group, when static points run out
    Start,                     // starts maps, by several cameras at once or by one alone
    ExpectedOverlap,           // cameras that should see the same, with too few shared points
    PlaceRecognition,          // recognises places: cameras put into maps, maps joined, loops closed
    DescriptorRequests,        // cameras that are asked for the descriptors of an image
    Verify,                    // checks every observation against its prediction; filter
    Classify,                  // moving points, and their positions
    ClockOffsets,              // offsets of the agents' clocks, from moving points
    StampLag,                  // cameras whose stamps are wrong by far, from moving points
    Register,                  // binds tracks without a point to known points
    MapIntra,                  // new points from one camera's motion
    Grouping,                  // view graph of this set, groups
    MapInter,                  // new points from two cameras at once
    MapMoving,                 // new moving points
    Fuse,                      // fuses points that two cameras made of one corner
    Cull,                      // removes points that turned out to be false
    Scale,                     // scale in metres, where something tells it
    Objects,                   // groups moving points that move as one
    AnnounceMoving,            // moving states for publication
    KeyFrames,                 // key frames, and plans for adjustments
    Correct,                   // map patches for the agents
    LastImages,                // last images of agents that have ended
    Forget>;                   // archives old parts of a long run

// Stages that receive something between frame sets, or act at the end of a run, by what they are asked for.
struct MapRole {
  using PlansAdjustment = KeyFrames;
  using TakesAdjustment = BundleAdjustment;
  using Answers = Correct;
  using KnowsPlaces = PlaceRecognition;
  using RemembersLastImages = LastImages;
  using FindsMisdated = StampLag;
  using KnowsScale = Scale;
};

struct MapServerConfig {
  MapConfig map;
  MapPipeline::Configs stages;

  // Configuration of one stage, for example of<LocaliseConfig>().
  template <class Config>
  Config& of() {
    return std::get<Config>(stages);
  }
};

template <class V>
void describe(V& v, MapServerConfig& c) {
  v.field("sigma_px", c.map.sigma_px, {0.1, 20}, "largest believed noise of a feature, at 640 px image width");
  v.field("theta", c.map.theta, {0.5, 10}, "Mahalanobis gate");
  v.field("recent_s", c.map.recent_s, {0.1, 10000}, "points seen so lately take part in registration (N_rec)");
  v.field("zncc_min", c.map.zncc_min, {-1, 1}, "correlation of two patches that show one place");
  v.field("zncc_margin", c.map.zncc_margin, {0, 1}, "of the best match over the second best");
  v.field("min_parallax_rad", c.map.min_parallax_rad, {0, 1}, "between the views that a point is made from");
  v.field("check_back_s", c.map.check_back_s, {0.1, 100},
          "N_min: of a track, in which a point that is to be its has to fit; points of younger ones are put on trial");
  v.field("failures", c.map.failures, {1, 100}, "gate failures in succession that unbind a track, or make it doubted");
  v.field("few_points", c.map.few_points, {0, 1000},
          "a camera that sees fewer proven points relies on those on trial and on directions too");
  v.field("new_view_rad", c.map.new_view_rad, {0, 1},
          "turn of the viewing ray between two views that tell something: filter updates, key frames, starts");
  v.field("match_period_s", c.map.match_period_s, {0.001, 10}, "between looks for tracks and points that are one");
  v.field(
      "rigs", c.map.rigs, read_rig_texts,
      "cameras that are fixed to another: [CAMERA FIRST x y z qx qy qz qw, ...], p_in_camera = T * p_in_first, metres; "
      "or as in a sequence: [{cameras: [A, B], cam_from_first: {B: [x, y, z, qx, qy, qz, qw]}}]");
  v.field("baseline_m", c.of<ScaleConfig>().baseline_m, {0, 1000},
          "known distance of the first two cameras at the start; 0 = unknown; goes before tag_m");
  v.field("tag_m", c.of<ScaleConfig>().tags.side_m, {0, 10},
          "side of the black square of every printed tag, metres; 0 = unknown; agents look for them, see agent.tags");
  v.field("lens", c.of<BundleAdjustmentConfig>().lens, {"auto", "given"},
          "auto: what is wrong about a calibration is found out, as far as the images say it; given: they are right");
  MapPipeline::describe_all(v, c.stages);
}

}  // namespace coslam
