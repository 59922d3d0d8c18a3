// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include "common/base/flat_map.h"
#include "common/base/workers.h"
#include "server/estimator/map/keys.h"
#include "server/estimator/pipeline/stage.h"
#include "server/estimator/solve/window.h"

namespace coslam {

struct WindowPoseConfig {
  bool enabled = true;
  double free_s = 0.4;  // age of the poses that are solved anew
  double seen_s = 4.0;  // age up to which observations count
};

template <class V>
void describe(V& v, WindowPoseConfig& c) {
  v.field("enabled", c.enabled, "newest poses of a camera that sees hardly any points, with all that it follows");
}

struct WindowPoseReport {
  std::vector<CameraId> solved;

  bool has(CameraId camera) const { return std::ranges::find(solved, camera) != solved.end(); }
  void count(auto&& add) const { add("windows", static_cast<long>(solved.size())); }
};

// Solves the newest poses of a camera that sees hardly any points anew. A camera that turns fast is in that state:
// earlier points are out of sight, and new tracks tell no depth yet, or not for long enough to become points. All
// tracks together, also those that have just ended, do determine its motion: the poses are solved with the directions
// and inverse depths of all that it followed in them (solve_window()). Begins when it sees half as many points as are
// few, ends when they are many again; older poses and points tie the poses to the map.
class WindowPose {
 public:
  static constexpr std::string_view kName = "window_pose";
  using Config = WindowPoseConfig;
  Config config;

  explicit WindowPose(const Config& c) : config(c) {}
  WindowPoseReport run(WindowPoseEdit& edit, const FrameSet& set, Workers& workers = Workers::alone());

 private:
  // Track, kept as long as it is of use, also when it has ended.
  struct Followed {
    std::vector<TrackPoint> seen;
    PointId point;
    bool rests = true;
    std::optional<Eigen::Vector4d> place;  // newest solution of its place: homogeneous, in the map
  };
  struct OfCamera {
    RunId run;
    LensCorrection lens;  // lens correction that all observations are undistorted with
    bool in_need = false;
    FlatMap<TrackId, Followed> tracks;
  };
  void remember(const Map& map, const MapCamera& camera, OfCamera* window) const;
  class Poses;
  std::optional<WindowThing> thing_of(const Map& map, const MapCamera& camera, const Followed& f, Poses* poses) const;
  bool solve(WindowPoseEdit& edit, const MapCamera& camera, OfCamera* window) const;

  std::map<CameraId, OfCamera> cameras_;
};

}  // namespace coslam
