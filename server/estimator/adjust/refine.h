// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/workers.h"
#include "server/estimator/map/map.h"
#include "server/estimator/solve/bundle.h"

namespace coslam {

// Extent of an adjustment in key frames of a map: the newest; an even subset of all, which corrects how the parts of
// the map lie to each other and takes seconds where all take minutes; or all.
enum class RefineExtent : std::uint8_t { kWindow, kOutline, kWhole };

struct BundleAdjustmentConfig {
  bool enabled = true;
  int window = 8;           // K: newest key frames whose poses are free
  int outline_poses = 400;  // most poses of an outline; exceeded where every third key frame has more
  int max_iterations = 10;
  int final_iterations = 40;  // limit for the adjustment of the whole run, at its end
  std::string lens = "auto";  // "auto": errors of calibrations are corrected; or "given"
  // Extent of the adjustment at the end: what changed since the map was last adjusted as a whole, which in a run
  // without an older map is the whole; the whole in any case; or nothing.
  std::string at_end = "changed";

  bool finds_lenses() const { return lens == "auto"; }
};

template <class V>
void describe(V& v, BundleAdjustmentConfig& c) {
  v.field("enabled", c.enabled, "bundle adjustment");
  v.field("window", c.window, {2, 200}, "K: newest key frames whose poses are free");
  v.field(
      "at_end", c.at_end, {"changed", "whole", "nothing"},
      "what is adjusted at the end of a run: what changed since the map of --map was adjusted, all of it, or nothing");
}

// Bundle adjustment over a copy of part of the map, solved in any thread, applied by the map's owner.
struct RefineJob {
  BundleProblem problem;
  struct PoseKey {
    SetId set;
    CameraId camera;
    double zoom_taken_out = 0;  // zoom that the observations were corrected for, see leave_zoom_out()
  };
  std::vector<PoseKey> poses;   // keys of problem.poses
  std::vector<PointId> points;  // keys of problem.points
  struct ObservationKey {
    SetId set;
    TrackId track;
  };
  std::vector<ObservationKey> observations;  // keys of problem.observations
  MapEpoch epoch;                            // epoch of the map at the plan
  MapId map;
  RefineExtent extent = RefineExtent::kWindow;
  bool for_lenses = false;  // applied only if the solution changes a lens
  bool zooms = false;       // tests whether focal lengths change from image to image, see zoom.h
  double set_s = 0;         // time from one frame set to the next
  bool floating = false;    // no pose but one was fixed: the solution is aligned to where the poses were
  BundleConfig config;
};

// Plans an adjustment of a map's key frames; empty when there is too little. Beyond the window all poses are free.
std::optional<RefineJob> plan_refine(const Map& map, MapId map_id, RefineExtent extent,
                                     const BundleAdjustmentConfig& config, Workers& workers = Workers::alone());
// Plans an outline of a map that changed since a set: of all of it if that has few enough poses; else of the newest key
// frames since then, as many as are allowed; earlier ones are fixed.
std::optional<RefineJob> plan_outline_since(const Map& map, MapId map_id, SetId first_set,
                                            const BundleAdjustmentConfig& config, Workers& workers = Workers::alone());
// Plans an adjustment of all key frames after a set; earlier ones are fixed.
std::optional<RefineJob> plan_refine_since(const Map& map, MapId map_id, SetId last_fixed,
                                           const BundleAdjustmentConfig& config);
// Cuts the newest key frames of a map with at most this many poses together, none fixed; for uncertainties, not to be
// adjusted.
std::optional<RefineJob> plan_newest(const Map& map, MapId map_id, int most_poses);
BundleResult solve_refine(const RefineJob& job);

}  // namespace coslam
