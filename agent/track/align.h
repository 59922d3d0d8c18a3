// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "agent/track/pyramid.h"
#include "agent/track/window.h"

namespace coslam {

// Where a window was found.
struct Alignment {
  bool found = false;
  Eigen::Vector2f px = Eigen::Vector2f::Zero();  // of level 0
  float zncc = 0.0f;                             // at the finest level used
};

// Inverse-compositional Lucas-Kanade: follows the window around from_px in `from` into `to`, coarse to fine over levels
// top ... bottom, starting at guess_px (both pixels of level 0). Levels without texture are passed over, except the
// finest, which must have it.
struct LevelRange {
  int top = 0;
  int bottom = 0;
};
Alignment align(const Pyramid& from, const Eigen::Vector2f& from_px, const Pyramid& to, const Eigen::Vector2f& guess_px,
                LevelRange levels);

// One level of it, from a prepared template: centre_px (pixels of that level) is moved to where the template is found.
// False when it runs out of the level or away.
bool align_level(const WindowTemplate& window, const PyramidLevel& level, int iterations, Eigen::Vector2f& centre_px);

}  // namespace coslam
