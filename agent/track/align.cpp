// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/align.h"

#include <cmath>

namespace coslam {
namespace {

constexpr int kFineIterations = 12;
constexpr int kCoarseIterations = 8;
constexpr float kConverged_px = 0.01f;
constexpr float kWidestStep_px = 4.0f;  // the linearisation says nothing about further away
constexpr float kFurthest_px = 8.0f;    // from the start, in pixels of a level
constexpr float kLeastGain = 0.2f;
// With noise of 2 grey levels the standard deviation of the position is 2 / sqrt(16) = 0.5 px.
constexpr double kLeastTexture = 16.0;

}  // namespace

bool align_level(const WindowTemplate& window, const PyramidLevel& level, int iterations, Eigen::Vector2f& centre_px) {
  Eigen::Vector2f at = centre_px;
  for (int i = 0; i < iterations; ++i) {
    if (!window_readable(level, at)) return false;
    const WindowStep step = window_step(level, at, window);
    if (!(step.gain > kLeastGain)) return false;
    const float length = step.d_px.norm();
    at -= step.d_px * (length > kWidestStep_px ? kWidestStep_px / length : 1.0f);
    if ((at - centre_px).squaredNorm() > kFurthest_px * kFurthest_px) return false;
    if (length < kConverged_px) break;
  }
  if (!window_readable(level, at)) return false;
  centre_px = at;
  return true;
}

Alignment align(const Pyramid& from, const Eigen::Vector2f& from_px, const Pyramid& to, const Eigen::Vector2f& guess_px,
                LevelRange levels) {
  Alignment result;
  Eigen::Vector2f motion = guess_px - from_px;
  WindowTemplate window;
  for (int l = levels.top; l >= levels.bottom; --l) {
    const float scale = 1.0f / static_cast<float>(1 << l);
    const Eigen::Vector2f centre = from_px * scale;
    if (!window_readable(from.level(l), centre)) return result;
    cut_template(from.level(l), centre, window);
    const bool finest = l == levels.bottom;
    if (window.min_eigenvalue < kLeastTexture) {
      if (finest) return result;
      continue;
    }
    Eigen::Vector2f at = centre + motion * scale;
    const bool aligned = align_level(window, to.level(l), finest ? kFineIterations : kCoarseIterations, at);
    if (aligned) motion = (at - centre) / scale;
    if (!finest) continue;
    if (!aligned) return result;
    result = {true, from_px + motion, window_zncc(to.level(l), at, window)};
  }
  return result;
}

}  // namespace coslam
