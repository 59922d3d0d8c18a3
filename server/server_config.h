// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map_server.h"
#include "server/store/event_store.h"
#include "server/sync/frame_set_sync.h"

// The keys of server.yaml below `server`, with unit and bounds (see common/config/config.h). Where the paper names a
// threshold, its name and value are used.
namespace coslam {

struct ServerConfig {
  MapServerConfig map;
  SyncConfig sync;
  EventsConfig events;
};

template <class V>
void describe(V& v, StartStageConfig& c) {
  v.field("min_matches", c.pair.min_matches, {10, 1000}, "between two cameras that start a map together");
  v.field("min_parallax_rad", c.pair.min_parallax_rad, {0.001, 1}, "median over their points");
  v.field("alone_after_sets", c.alone_after_sets, {0, 10000}, "a camera that nobody placed starts a map of its own");
  v.field("min_flow_px", c.min_flow_px, {1, 200}, "median displacement of its tracks for that, at 640 px image width");
}

template <class V>
void describe(V& v, MeetConfig& c) {
  v.field("loops", c.loops, "recognise places seen long ago and draw the map together");
  v.field("min_place_inliers", c.recognise.min_inliers, {8, 1000}, "to place a camera by its descriptors");
  v.field("min_merge_inliers", c.min_merge_inliers, {8, 1000}, "to join two maps or draw one together");
  v.field("lost_period_sets", c.lost_period, {1, 1000},
          "between requests for descriptors while a camera is to be placed");
  v.field("apart_period_sets", c.apart_period, {1, 1000}, "the same while there are several maps");
  v.field("expect_period_sets", c.expect_period, {1, 1000},
          "the same while it should see what a camera sees that nothing holds it to");
  v.field("min_overlap", c.min_overlap, {0, 1}, "of both views, by the map, for that");
  v.field("least_period_sets", c.least_period, {1, 1000}, "the same because the view changed");
  v.field("images_per_s", c.images_per_s, {0, 100}, "described by a camera that has a map, in the long run");
  v.field("image_burst", c.image_burst, {1, 1000}, "and so many ahead of that");
  v.field("turned_rad", c.turned_rad, {0.01, 3}, "turn that changes the view");
  v.field("moved_share", c.moved_share, {0.01, 10}, "the same for a shift, of the median depth");
}

template <class V>
void describe(V& v, LocaliseConfig& c) {
  v.field("min_inliers", c.min_inliers, {6, 1000}, "static points that agree with a pose; fewer: lost");
  v.field("min_inlier_ratio", c.min_inlier_ratio, {0, 1}, "of the static points seen; fewer: lost");
  v.field("lost_after_sets", c.lost_after_sets, {1, 10000}, "without a pose for so long, a camera leaves its map");
}

template <class V>
void describe(V& v, InterPoseConfig& c) {
  v.field("enabled", c.enabled, "poses from static and moving points of a whole group");
  v.field("hull_area_min", c.hull_area_min, {0, 1}, "of the image that static points cover; less: called");
  v.field("max_iterations", c.max_iterations, {1, 200}, "of the solver");
  v.field("min_inliers", c.min_inliers, {6, 1000}, "static and moving together, of each camera");
  v.field("min_moving", c.min_moving, {1, 1000}, "moving points that two cameras of the group see");
}

template <class V>
void describe(V& v, VerifyConfig& c) {
  v.field("failures", c.failures, {1, 100}, "gate failures in succession that unbind a track");
  v.field("prove_views", c.prove_views, {1, 1000}, "frames inside the gate that prove a point of one camera");
  v.field("sparse_points", c.sparse_points, {0, 1000}, "a camera with fewer proven points relies on the others too");
  v.field("update_turn_rad", c.update_turn_rad, {0, 1},
          "turn of the viewing ray between two filter updates of a point");
}

template <class V>
void describe(V& v, ClassifyConfig& c) {
  v.field("enabled", c.enabled, "tell moving points from static ones");
  v.field("failures", c.failures, {1, 100}, "gate failures in succession that make a point uncertain");
  v.field("still_frames", c.still_frames, {2, 1000}, "a moving point that stood so long is static again");
  v.field("still_px_s", c.still_px_s, {0, 1000}, "apparent speed below which a thing stands, at 640 px image width");
  v.field("least_frames", c.least_frames, {2, 200}, "age at which an unmapped track is tested for motion");
  v.field("test_frames", c.test_frames, {4, 200}, "of an unmapped track that are tested for motion");
  v.field("doubtful_px", c.doubtful_px, {0.5, 50},
          "that it misses every static point by, at 640 px image width: it is not mapped");
  v.field("motion_px", c.motion_px, {0.5, 50}, "the same, to be called moving");
  v.field("motion_parallax", c.motion_parallax, {0, 10}, "and at least so much of the parallax at the median depth");
  v.field("neighbour_share", c.neighbour_share, {0, 1}, "of the tracks around it that must move too");
  v.field("neighbour_radius", c.neighbour_radius, {0, 1}, "of the larger image side");
}

template <class V>
void describe(V& v, ClockConfig& c) {
  v.field("enabled", c.enabled, "estimate the offsets of the agents' clocks from what moves");
  v.field("period", c.period, {1, 10000}, "frame sets between estimates");
  v.field("memory_s", c.memory_s, {1, 10000}, "what was seen longer ago does not count");
  v.field("max_sigma_s", c.max_sigma_s, {0, 1}, "of an offset that is used");
  v.field("significance", c.significance, {0, 100}, "of its sigmas that an offset must be to be used");
}

template <class V>
void describe(V& v, RegisterConfig& c) {
  v.field("zncc_min", c.zncc_min, {-1, 1}, "patch correlation");
  v.field("check_back", c.check_back, {1, 1000}, "frames of the track in which the gate must hold");
  v.field("min_track_frames", c.min_track_frames, {1, 1000}, "younger tracks wait");
}

template <class V>
void describe(V& v, MapIntraConfig& c) {
  v.field("min_track_frames", c.min_track_frames, {2, 10000}, "N_min: such tracks may become points");
  v.field("min_parallax_rad", c.min_parallax_rad, {0, 1}, "of a track that long");
  v.field("early_track_frames", c.early_track_frames, {2, 10000},
          "shorter tracks down to this may too, with more parallax");
  v.field("early_parallax_rad", c.early_parallax_rad, {0, 1}, "of a track that is shorter than N_min");
  v.field("max_relative_sigma", c.max_relative_sigma, {0, 10}, "sqrt(trace Sigma) of a new point over its distance");
}

template <class V>
void describe(V& v, MapInterConfig& c) {
  v.field("inter_mapping_period", c.period, {1, 1000}, "frame sets between runs");
  v.field("moving_period", c.moving_period, {1, 1000}, "the same for moving points");
  v.field("zncc_min", c.zncc_min, {-1, 1}, "patch correlation");
  v.field("zncc_margin", c.zncc_margin, {0, 1}, "of the best match over the second best");
  v.field("seed_radius", c.seed_radius, {0, 1}, "phi_r, of the larger image side");
  v.field("disparity_gate", c.disparity_gate, {0, 100}, "phi_d over phi_r");
  v.field("min_parallax_rad", c.min_parallax_rad, {0, 1}, "between the two cameras");
  v.field("max_relative_sigma", c.max_relative_sigma, {0, 10}, "sqrt(trace Sigma) of a new point over its distance");
  v.field("check_back", c.check_back, {1, 1000}, "earlier frames in which the point must fit both tracks");
  v.field("moving_check_back", c.moving_check_back, {2, 1000},
          "instants at which two tracks of a moving thing must have met");
}

template <class V>
void describe(V& v, FuseConfig& c) {
  v.field("period", c.period, {1, 1000}, "frame sets between runs");
  v.field("zncc_min", c.zncc_min, {-1, 1}, "patch correlation");
  v.field("check_back", c.check_back, {1, 1000}, "frames of each track in which the fused point must fit");
}

template <class V>
void describe(V& v, CullConfig& c) {
  v.field("probation_sets", c.probation_sets, {1, 10000}, "by when a new point must have been seen well");
  v.field("min_views", c.min_views, {1, 10000}, "frames in which it passed the gate by then");
}

template <class V>
void describe(V& v, ObjectsConfig& c) {
  v.field("reach_m", c.reach_m, {0.01, 1000}, "between neighbouring points of a body, when the scale is known");
  v.field("reach_share", c.reach_share, {0.001, 1}, "the same when it is not, of the distance from the cameras");
  v.field("path_s", c.path_s, {0.2, 10}, "newest part of the paths that is compared and gives the velocity");
  v.field("min_path_s", c.min_path_s, {0.05, 10}, "points with shorter paths wait");
  v.field("max_sigma", c.max_sigma, {0.01, 10}, "of a point's position, of the reach; less certain ones wait");
  v.field("stretch", c.stretch, {0.01, 10}, "of the reach, by which distances within a body may change");
  v.field("shift", c.shift, {0.01, 10}, "of the reach, by which parts of a body may shift against each other");
  v.field("speed_gate", c.speed_gate, {0.01, 100}, "of the reach a second, for an object that is seen again");
  v.field("min_speed", c.min_speed, {0, 100}, "of the reach a second, of a new object");
  v.field("min_points", c.min_points, {2, 1000}, "of a new object");
  v.field("keep_s", c.keep_s, {0, 100}, "an object out of sight for so long is forgotten");
}

template <class V>
void describe(V& v, GroupConfig& c) {
  v.field("min_shared", c.min_shared, {1, 1000}, "points that bring two cameras into one group");
  v.field("keep_shared", c.keep_shared, {0, 1000}, "points that keep them in it");
  v.field("min_overlap", c.min_overlap, {0, 1}, "of both views, by the map, that keeps them in it without any");
  v.field("min_shared_overlapping", c.min_shared_overlapping, {1, 1000},
          "points that bring two cameras into one group if their views overlap so far; fewer do if farther");
  v.field("join_s", c.join_s, {0, 10}, "for so long before they join");
  v.field("part_s", c.part_s, {0, 10}, "with fewer for so long before they part");
  v.field("settle_s", c.settle_s, {0, 10}, "that a new grouping must last before it counts");
  v.field("hold_s", c.hold_s, {0, 60}, "that every grouping stays at least");
}

template <class V>
void describe(V& v, KeyFrameConfig& c) {
  v.field("keyframe_drop", c.drop, {0.01, 1}, "of a camera's points since the last key frame");
  v.field("min_sets", c.min_sets, {1, 1000}, "between key frames");
  v.field("max_sets", c.max_sets, {1, 10000}, "between key frames while a camera moves");
  v.field("moved_rad", c.moved_rad, {0, 1}, "median turn of the rays to a camera's points that counts as having moved");
}

template <class V>
void describe(V& v, RefineConfig& c) {
  v.field("enabled", c.enabled, "bundle adjustment");
  v.field("window", c.window, {2, 200}, "K: newest key frames whose poses are free");
  v.field("most_fixed", c.most_fixed, {0, 1000}, "older poses that hold them");
  v.field("max_iterations", c.max_iterations, {1, 200}, "of one bundle adjustment");
  v.field("final_iterations", c.final_iterations, {1, 1000}, "over the whole run, at its end");
}

template <class V>
void describe(V& v, PatchWriterConfig& c) {
  v.field("moved_px", c.moved_px, {0, 100}, "a point is sent again when it moved so far in the agent's image");
  v.field("covariance_ratio", c.covariance_ratio, {1, 1000}, "or its covariance changed by this factor");
  v.field("patch_period_sets", c.patch_period, {1, 1000}, "between requests for image patches");
  v.field("patches_per_request", c.patches_per_request, {0, 1000},
          "image patches asked for at once, at most, of tracks that move and of others each");
  v.field("patch_track_frames", c.patch_track_frames, {1, 1000}, "age at which a track is asked for its patch");
  v.field("patch_refresh_sets", c.patch_refresh_sets, {1, 10000}, "after which an unmapped track is asked again");
  v.field("moving_patch_refresh_sets", c.moving_patch_refresh_sets, {1, 10000}, "the same for tracks that move");
}

template <class V>
void describe(V& v, TagScaleConfig& c) {
  v.field("max_sigma", c.max_sigma, {0.0001, 1}, "of a scale from printed tags, relative; less certain ones wait");
  v.field("period_sets", c.period, {1, 1000}, "between measurements of the tags");
}

template <class V>
void describe(V& v, SyncConfig& c) {
  v.field("tolerance_frames", c.tolerance_frames, {0, 1}, "frames this close (of the period) belong to one instant");
  v.field("deadline_s", c.deadline_s, {0, 10}, "live: how long a frame set waits for the last agent");
  v.field("queue_frames", c.queue_frames, {1, 10000}, "waiting per agent at most");
}

template <class V>
void describe(V& v, ServerConfig& c) {
  v.field("sigma_px", c.map.map.sigma_px, {0.1, 20}, "largest believed noise of a feature, at 640 px image width");
  v.field("theta", c.map.map.theta, {0.5, 10}, "Mahalanobis gate");
  v.field("active_frames", c.map.map.active_frames, {1, 100000},
          "N_rec: points seen in so many last sets take part in registration");
  v.field("baseline_m", c.map.baseline_m, {0, 1000},
          "known distance of the first two cameras at the start; 0 = unknown; goes before tag_m");
  v.field("tag_m", c.map.tags.side_m, {0, 1000},
          "side of the black square of every printed tag; 0 = unknown; agents look for them, see agent.tags");
  v.section("sync", c.sync);
  v.section("events", c.events);
  v.section("tags", c.map.tags);
  v.section("start", c.map.start);
  v.section("meet", c.map.meet);
  v.section("localise", c.map.localise);
  v.section("inter_pose", c.map.inter_pose);
  v.section("verify", c.map.verify);
  v.section("classify", c.map.classify);
  v.section("clock", c.map.clock);
  v.section("register", c.map.registration);
  v.section("map_intra", c.map.intra);
  v.section("map_inter", c.map.inter);
  v.section("fuse", c.map.fuse);
  v.section("cull", c.map.cull);
  v.section("objects", c.map.objects);
  v.section("group", c.map.group);
  v.section("key_frame", c.map.key_frame);
  v.section("refine", c.map.refine);
  v.section("patches", c.map.patches);
}

}  // namespace coslam
