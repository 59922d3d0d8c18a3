// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "common/base/time.h"
#include "server/estimator/map/sighting.h"
#include "server/estimator/reports/objects_report.h"

// Paths of moving points: position and velocity of a point and of the body that it is part of.
namespace coslam {

struct PathSample {
  SetId set;
  TimeNs t_ns = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};
using MovingPath = std::vector<PathSample>;  // sorted by set

struct PointMotion {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  double span_s = 0;  // time span of the samples behind the velocity
};

// Fits a curve to the samples from from_ns to to_ns, which gives the velocity at at_ns; the sample next to it, carried
// on with the velocity, gives the position. Empty when there are fewer than three samples, when they span less than
// min_span_s, or end so long before or begin so long after at_ns.
std::optional<PointMotion> motion_at(const MovingPath& path, TimeNs at_ns, TimeNs from_ns, TimeNs to_ns,
                                     double min_span_s);

// Combines the motions of one body's points, at least one.
BodyMotion body_of(std::span<const PointMotion> points);

}  // namespace coslam
