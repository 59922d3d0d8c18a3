// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/align.h"

#include <algorithm>
#include <cmath>

#include "agent/track/match_limits.h"
#include "agent/track/window.h"

namespace coslam {
namespace {

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
