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

// Which key frames of a map are adjusted: the newest; some of all, which tells how the parts of the map lie to each
// other and takes seconds where all take minutes; or all.
enum class RefineExtent : std::uint8_t { kWindow, kOutline, kWhole };

struct BundleAdjustmentConfig {
  bool enabled = true;
  int window = 8;           // K: newest key frames whose poses are free
  int outline_poses = 400;  // of an outline; of all that is known more where every third key frame has more
  int max_iterations = 10;
  int final_iterations = 40;  // over the whole run, at its end
  std::string lens = "auto";  // what is wrong about calibrations is found out; or "given"
  // What is adjusted at the end: what changed since the map was last adjusted as a whole, which in a run on no older
  // map is the whole; the whole in any case; or nothing.
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

// A bundle adjustment over a copy of part of the map, solved anywhere, applied by the map's owner.
struct RefineJob {
  BundleProblem problem;
  struct PoseKey {
    SetId set;
    CameraId camera;
    double zoom_taken_out = 0;  // of what was observed there, see leave_zoom_out()
  };
  std::vector<PoseKey> poses;   // as problem.poses
  std::vector<PointId> points;  // as problem.points
  struct ObservationKey {
    SetId set;
    TrackId track;
  };
  std::vector<ObservationKey> observations;  // as problem.observations
  MapEpoch epoch;                            // of the map it was cut from
  MapId map;
  RefineExtent extent = RefineExtent::kWindow;
  bool for_lenses = false;  // a solution that has nothing to say of a lens is left
  bool zooms = false;       // whether focal lengths change from image to image is asked, see zoom.h
  double set_s = 0;         // from one frame set to the next
  bool floating = false;    // no pose was fixed but one: the solution is put back to where the poses were
  BundleConfig config;
};

// Cuts a map's key frames out; empty when there is too little. Beyond the window all poses are free.
std::optional<RefineJob> plan_refine(const Map& map, MapId of, RefineExtent extent,
                                     const BundleAdjustmentConfig& config, Workers& workers = Workers::alone());
// The outline of a map that changed since a set: of all of it where that takes no more than it may; else of its key
// frames since then, of the newest that may be; those before hold them and stay.
std::optional<RefineJob> plan_outline_since(const Map& map, MapId of, SetId since, const BundleAdjustmentConfig& config,
                                            Workers& workers = Workers::alone());
// For all key frames after a set; those before it hold them and stay.
std::optional<RefineJob> plan_refine_since(const Map& map, MapId of, SetId since, const BundleAdjustmentConfig& config);
// The newest key frames of a map with so many poses together, none held; not to be adjusted, but to be judged.
std::optional<RefineJob> plan_newest(const Map& map, MapId of, int most_poses);
BundleResult solve_refine(const RefineJob& job);

}  // namespace coslam
