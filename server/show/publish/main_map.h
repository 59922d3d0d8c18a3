// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>

#include "server/estimator/map/journal.h"
#include "server/estimator/map/map.h"

namespace coslam {

// Selects the map whose frame is the public one: that with the most frames, as the result has it in the end (counted as
// they come, since looking through all frames of a long run takes time). Another map has to have clearly more to take
// its place, so that the public frame seldom changes.
class MainMap {
 public:
  // Frames that were there before the first set, as of a map that was restored.
  void begin_with(MapId map, long frames) { frames_[map] += frames; }
  void after_set(const Map& map, const FrameSet& set, const Journal& journal);

  MapId id() const { return main_; }  // 0: there is none yet
  std::size_t maps() const { return frames_.size(); }

 private:
  std::map<MapId, long> frames_;
  MapId main_;
};

}  // namespace coslam
