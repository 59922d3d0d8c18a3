// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/geometry/rigid3.h"

namespace coslam {

// The covariance of a camera's place and of its turns about the axes of the world, in this order, from that of
// cam_from_world in the order of retract().
Matrix6d camera_covariance_in_world(const Rigid3& cam_from_world, const Matrix6d& covariance);

}  // namespace coslam
