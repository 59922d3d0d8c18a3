// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/main_map.h"

#include <algorithm>

namespace coslam {

void MainMap::after_set(const Map& map, const FrameSet& set, const Journal& journal) {
  constexpr double kClearly = 1.25;
  for (const Event& e : journal.events()) {
    if (e.kind != EventKind::kMapMerged) continue;
    frames_[e.map] += frames_[e.from];
    frames_.erase(e.from);
    if (main_ == e.from) main_ = e.map;
  }
  for (const CameraFrame& cf : set.frames) {
    const auto& frames = map.camera(cf.camera).frames;
    if (!frames.empty() && frames.back().set == set.id && frames.back().valid()) ++frames_[frames.back().map];
  }
  if (frames_.empty()) return;
  const auto most = std::ranges::max_element(frames_, {}, [](const auto& m) { return m.second; });
  const auto now = frames_.find(main_);
  const bool clearly =
      now == frames_.end() || static_cast<double>(most->second) > kClearly * static_cast<double>(now->second);
  if (clearly) main_ = most->first;
}

}  // namespace coslam
