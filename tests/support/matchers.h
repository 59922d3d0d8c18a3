// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <cmath>

#include "common/geometry/rigid3.h"

// Matchers with two tolerances: EXPECT_THAT(pose, PoseNear(truth, angle_rad, distance)).
namespace coslam::test {

// A cam_from_world pose whose rotation and whose camera centre are near the expected ones.
MATCHER_P3(PoseNear, expected, angle_rad, distance, "") {
  const double angle = arg.rotation.angularDistance(expected.rotation);
  const double apart = (arg.center() - expected.center()).norm();
  *result_listener << "off by " << angle << " rad and " << apart;
  return angle <= angle_rad && apart <= distance && std::abs(arg.rotation.norm() - 1) < 1e-9;
}

// A similarity near the expected one; scale_ratio bounds |log(scale / expected scale)|.
MATCHER_P4(SimilarityNear, expected, angle_rad, distance, scale_ratio, "") {
  const double angle = arg.rotation.angularDistance(expected.rotation);
  const double apart = (arg.translation - expected.translation).norm();
  const double ratio = std::abs(std::log(arg.scale / expected.scale));
  *result_listener << "off by " << angle << " rad, " << apart << " and a scale of exp " << ratio;
  return angle <= angle_rad && apart <= distance && ratio <= scale_ratio;
}

// A point or pixel near the expected one.
MATCHER_P2(VectorNear, expected, distance, "") {
  const double apart = (arg - expected).norm();
  *result_listener << "off by " << apart;
  return apart <= distance;
}

}  // namespace coslam::test
