// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agent/agent.h"
#include "agent/gpu/matcher_for.h"

// The keys of agent.yaml below `agent`, with unit and bounds (see common/config/config.h).
namespace coslam {

// A frame has room for the tracks and as many again, which an answer to a descriptor request may add.
inline constexpr int kMostTracks = kMaxTracks / 2, kMostDescribed = kMaxTracks - kMaxTracks / 2;

template <class V>
void describe(V& v, TrackerConfig& c) {
  v.field("max_tracks", c.max_tracks, {20, kMostTracks}, "features followed at once");
  v.field("levels", c.levels, {1, 8}, "pyramid levels, the full image included");
  v.field("min_distance_px", c.min_distance_px, {2, 200}, "of a new corner to any live track, at 640 px image width");
  v.field("forward_backward_px", c.forward_backward_px, {0.05, 10}, "largest return error of a track");
  v.field("min_zncc", c.min_zncc, {0, 1}, "of a track with the image before and with where it started");
  v.field("min_eigenvalue", c.min_eigenvalue, {0, 1}, "of a corner, relative to the strongest of recent images");
  v.field("most_width_px", c.most_width_px, {160, 16384}, "wider images are shrunk to that for tracking");
  v.field("border_px", c.border_px, {1, 100}, "tracks end this close to the image border");
  v.field("device", c.device, tracker_devices(), "that works on the images; auto: a GPU where there is one");
  v.field("mask", c.mask,
          "image of the camera's size, black where nothing is tracked: own body, overlays; empty: none");
}

template <class V>
void describe(V& v, PoseTrackerConfig& c) {
  v.field("sigma_px", c.sigma_px, {0.1, 20}, "largest believed noise of a feature, at 640 px image width");
  v.field("min_inliers", c.min_inliers, {6, 1000}, "fewer: lost");
  v.field("min_inlier_ratio", c.min_inlier_ratio, {0, 1}, "of the static points seen; fewer: lost");
}

template <class V>
void describe(V& v, TagConfig& c) {
  v.field("family", c.family, tag_families(), "of the printed tags to look for; none: not looked for");
  v.field("period_s", c.period_s, {0, 100}, "between images that are searched for them");
}

template <class V>
void describe(V& v, AgentConfig& c) {
  v.section("tracker", c.tracker);
  v.section("pose", c.pose);
  v.section("tags", c.tags);
  v.field(
      "readout_s", c.readout_s, {-1, 0.2},
      "of a rolling shutter, from the first row to the last; 0: global shutter; -1: found out while the camera turns");
  v.field("thumbnails", c.thumbnails,
          "small images for the live page, when somebody there asks to see what the camera sees; false: none, ever");
  v.field("descriptor_features", c.descriptor_features, {50, kMostDescribed},
          "most in an answer to a descriptor request");
  v.field("place_features", c.place_features, {10, kMostDescribed},
          "at most, when only those at tracks are to be described");
}

}  // namespace coslam
