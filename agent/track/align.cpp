// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/align.h"

#include <algorithm>
#include <cmath>

#include "agent/track/window.h"

namespace coslam {
namespace {

constexpr int kFineIterations = 12;
constexpr int kCoarseIterations = 8;
constexpr float kConvergedFine_px = 0.01f;
constexpr float kConvergedCoarse_px = 0.05f;
constexpr float kWidestStep_px = 4.0f;  // the linearisation says nothing about further away
constexpr float kFurthest_px = 8.0f;    // from the start, in pixels of the level
constexpr float kLeastGain = 0.2f;
// With noise of 2 grey levels the standard deviation of the position is 2 / sqrt(16) = 0.5 px.
constexpr double kLeastTexture = 16.0;
constexpr int kGuessLevel = 2;       // a window spans 64 px of level 0
constexpr float kAlike_zncc = 0.8f;  // less than about 10 px off

// Moves at_px, pixels of the level, to where the template is found. False when the search runs away.
bool align_level(const WindowTemplate& window, const PyramidLevel& level, bool fine, Eigen::Vector2f& at_px) {
  const float converged = fine ? kConvergedFine_px : kConvergedCoarse_px;
  Eigen::Vector2f at = at_px;
  for (int i = 0; i < (fine ? kFineIterations : kCoarseIterations); ++i) {
    if (!window_readable(level, at)) return false;
    const WindowStep step = window_step(level, at, window);
    if (!(step.gain > kLeastGain)) return false;
    const float length = step.offset_px.norm();
    at -= step.offset_px * (length > kWidestStep_px ? kWidestStep_px / length : 1.0f);
    if ((at - at_px).squaredNorm() > kFurthest_px * kFurthest_px) return false;
    if (length < converged) break;
  }
  if (!window_readable(level, at)) return false;
  at_px = at;
  return true;
}

}  // namespace

WindowAlignment align(const Pyramid& from, const Eigen::Vector2f& from_px, const Pyramid& to,
                      const Eigen::Vector2f& guess_px, int top) {
  WindowAlignment result;
  Eigen::Vector2f motion = guess_px - from_px;
  WindowTemplate window;
  for (int l = std::min(top, from.levels() - 1); l >= 0; --l) {
    const float scale = 1.0f / static_cast<float>(1 << l);
    const Eigen::Vector2f centre = from_px * scale;
    if (!window_readable(from.level(l), centre)) continue;
    cut_template(from.level(l), centre, window);
    if (window.min_eigenvalue < kLeastTexture) continue;
    Eigen::Vector2f at = centre + motion * scale;
    if (!align_level(window, to.level(l), l == 0, at)) continue;
    motion = (at - centre) / scale;
    if (l == 0) result = {true, from_px + motion, window_zncc(to.level(0), at, window)};
  }
  return result;
}

Guess best_guess(const Pyramid& from, const Eigen::Vector2f& from_px, const Pyramid& to,
                 std::span<const Eigen::Vector2f> guesses_px) {
  const int l = std::min(kGuessLevel, from.levels() - 1);
  const float scale = 1.0f / static_cast<float>(1 << l);
  Guess best = {guesses_px[0], from.levels() - 1};
  if (!window_readable(from.level(l), from_px * scale)) return best;
  WindowTemplate window;
  cut_template(from.level(l), from_px * scale, window);
  float best_zncc = -2.0f;
  for (const Eigen::Vector2f& guess : guesses_px) {
    if (!window_readable(to.level(l), guess * scale)) continue;
    const float zncc = window_zncc(to.level(l), guess * scale, window);
    if (zncc > best_zncc) best_zncc = zncc, best.px = guess;
  }
  if (best_zncc > kAlike_zncc) best.top = std::max(0, l - 1);
  return best;
}

}  // namespace coslam
