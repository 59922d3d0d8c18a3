// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "common/geometry/alignment.h"
#include "tests/support/sim_map.h"

namespace coslam::test {

inline CameraId cam(int i) { return CameraId(static_cast<std::uint16_t>(i)); }

// Poses and points of one map against truth, after the best similarity.
struct Fit {
  Similarity3 map_from_world;
  double worst_pose_m = 0, worst_pose_rad = 0;
  double median_point_m = 0;  // metres of truth
  int poses = 0, points = 0;
};

inline Fit fit_of(const SimMap& sim, MapId of) {
  Fit fit;
  std::vector<Eigen::Vector3d> truth, mapped;
  for (const auto& [id, p] : sim.map.points()) {
    const int point = sim.world_point(p);
    if (p.map != of || point < 0) continue;
    truth.push_back(sim.world.position(point));
    mapped.push_back(p.position);
  }
  fit.points = static_cast<int>(truth.size());
  const Alignment a = align_points(truth, mapped, AlignmentScale::kFree);
  if (!a.target_from_source) return fit;
  fit.map_from_world = *a.target_from_source;
  std::vector<double> errors;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    errors.push_back((mapped[i] - fit.map_from_world * truth[i]).norm() / fit.map_from_world.scale);
  }
  fit.median_point_m = median(errors);
  for (const MapCamera& c : sim.map.cameras()) {
    for (const FramePose& f : c.frames) {
      if (f.map != of) continue;
      const Rigid3 expected = transform_world(sim.truth(c.id, f.set), fit.map_from_world);
      const double apart = (expected.center() - f.cam_from_world.center()).norm() / fit.map_from_world.scale;
      fit.worst_pose_m = std::max(fit.worst_pose_m, apart);
      fit.worst_pose_rad = std::max(fit.worst_pose_rad, expected.rotation.angularDistance(f.cam_from_world.rotation));
      ++fit.poses;
    }
  }
  return fit;
}

}  // namespace coslam::test
