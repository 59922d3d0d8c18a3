// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// State machines of points and tracks. Transitions have reasons, see Why (journal.h).
namespace coslam {

// State of a point.
//
//   from    to      when
//   -       trial   mapped from a short track of one camera, or from the start of a map
//   -       static  mapped from a long track, or from two cameras
//   -       moving  two cameras follow one thing that moves
//   trial   static  seen inside the gate for long enough
//   trial   moving  several cameras see it elsewhere, and agree where
//   static  moving  several cameras see it elsewhere, and agree where
//   static  trial   its map has just been started
//   moving  trial   it stopped
//
// Poses, filter and bundle adjustment rest on static points, and on those on trial only where there is nothing better.
// A false point is removed: there is no state for it.
enum class PointPhase : std::uint8_t { kTrial, kStatic, kMoving };

constexpr bool may_become(PointPhase from, PointPhase to) {
  using enum PointPhase;
  return (from == kTrial && to != kTrial) || (from == kStatic && to != kStatic) || (from == kMoving && to == kTrial);
}

// Motion of what a track follows, as far as its own camera can tell, or by the point that it is bound to.
//
//   from      to        when
//   resting   doubtful  no static place explains it well: it is not mapped as static
//   resting   moving    it misses every static place by more, and so do its neighbours; or it is bound to what moves
//   doubtful  moving    it misses every static place by more, and so do its neighbours; or it is bound to what moves
//   doubtful  resting   a static place explains it again
//   moving    resting   a static place, near enough to pass by, explains it again; or its point stopped
//   moving    doubtful  it misses by less than before
enum class TrackMotion : std::uint8_t { kResting, kDoubtful, kMoving };

}  // namespace coslam
