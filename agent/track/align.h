// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "agent/track/pyramid.h"

namespace coslam {

// Result of aligning a window.
struct WindowAlignment {
  bool found = false;
  Eigen::Vector2f px = Eigen::Vector2f::Zero();  // pixel of level 0
  float zncc = 0.0f;                             // at the finest level used
};

// Pyramidal inverse-compositional Lucas-Kanade with a gain and an offset: follows the window around from_px in `from`
// into `to`, from level `top` down to level 0, starting at guess_px; both pixels of level 0. A level without texture,
// or where the search runs away, is passed over; level 0 must succeed.
WindowAlignment align(const Pyramid& from, const Eigen::Vector2f& from_px, const Pyramid& to,
                      const Eigen::Vector2f& guess_px, int top);

// Selects from several guesses the one whose surroundings in `to`, seen at a coarse level, look most like those of
// from_px in `from`, and the level to start from: where they look alike, coarser ones have nothing to add.
struct Guess {
  Eigen::Vector2f px = Eigen::Vector2f::Zero();
  int top = 0;
};
Guess best_guess(const Pyramid& from, const Eigen::Vector2f& from_px, const Pyramid& to,
                 std::span<const Eigen::Vector2f> guesses_px);

}  // namespace coslam
