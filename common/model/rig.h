// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/rigid3.h"

namespace coslam {

// A camera that is fixed to another one, the first of their rig; lengths are metres.
struct RigCamera {
  std::string camera, first;  // names of agents
  Rigid3 cam_from_first;      // p_in_cam = cam_from_first * p_in_first
};

// Writes the camera as one text: "CAMERA FIRST x y z qx qy qz qw".
std::string text_of(const RigCamera& camera);
// Throws UserError with the reason.
RigCamera parse_rig_camera(std::string_view text);
// The transform as seven numbers x y z qx qy qz qw; throws UserError when they are none.
Rigid3 rig_transform(const std::vector<double>& numbers);

}  // namespace coslam
