// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "common/geometry/rigid3.h"
#include "deploy/simulation/caster.h"

namespace coslam::sim {

// The parts shortly before and after an instant.
struct PartMotion {
  std::vector<Rigid3> before, after;
  double apart_s = 0;
};

// Poses and velocities of the moving parts of a world at one instant. Thread-safe; the caster must outlive it.
class PosedParts {
 public:
  PosedParts(const Caster& caster, double t_s, std::vector<Rigid3> world_from_parts, const PartMotion& motion);
  double t_s() const { return t_s_; }
  std::size_t parts() const { return world_from_parts_.size(); }
  const Rigid3& world_from_part(std::size_t part) const { return world_from_parts_[part]; }
  // World, of a place in the frame of the part.
  Eigen::Vector3d velocity(std::size_t part, const Eigen::Vector3d& in_part) const;
  const PosedCaster& caster() const { return caster_; }

 private:
  struct Twist {
    Eigen::Vector3d linear_m_s, angular_rad_s;  // world; linear: of the part's origin
  };
  double t_s_;
  std::vector<Rigid3> world_from_parts_;
  std::vector<Twist> twists_;
  PosedCaster caster_;
};

}  // namespace coslam::sim
