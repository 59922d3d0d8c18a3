// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "deploy/simulation/scene.h"

namespace coslam::sim {

// Computes the share of the surfaces that one camera sees and another sees too, so that they look alike: at most 45
// degrees apart, and at most 2.5 times as far away.
class ViewOverlap {
 public:
  explicit ViewOverlap(const Scene& scene);  // the scene must outlive it
  // Element (a, b): of the pixels of a on a coarse grid, the share whose surface lies open in the image of b.
  Eigen::MatrixXd at(double t_s) const;

 private:
  // way: to the point, from a camera that sees it.
  bool seen_by(int camera, const Rigid3& cam_from_world, const Eigen::Vector3d& point, const Eigen::Vector3d& way,
               double t_s) const;

  const Scene& scene_;
  std::vector<std::vector<Eigen::Vector3d>> rays_;  // rays of each camera, in its frame
};

}  // namespace coslam::sim
