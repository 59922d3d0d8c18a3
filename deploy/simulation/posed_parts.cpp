// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/posed_parts.h"

#include <Eigen/Geometry>
#include <utility>

namespace coslam::sim {

PosedParts::PosedParts(const Caster& caster, double t_s, std::vector<Rigid3> world_from_parts, const PartMotion& motion)
    : t_s_(t_s), world_from_parts_(std::move(world_from_parts)), caster_(caster, world_from_parts_) {
  for (std::size_t i = 0; i < world_from_parts_.size(); ++i) {
    const Rigid3 &before = motion.before[i], &after = motion.after[i];
    twists_.push_back({(after.translation - before.translation) / motion.apart_s,
                       so3_log(after.rotation * before.rotation.conjugate()) / motion.apart_s});
  }
}

Eigen::Vector3d PosedParts::velocity(std::size_t part, const Eigen::Vector3d& in_part) const {
  const Twist& twist = twists_[part];
  return twist.linear_m_s + twist.angular_rad_s.cross(world_from_parts_[part].rotation * in_part);
}

}  // namespace coslam::sim
