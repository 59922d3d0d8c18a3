// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/sync/backlog.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace coslam {

std::vector<FrameSet> Backlog::thin(std::size_t most) {
  std::vector<FrameSet> out;
  while (waiting_.size() > most) {
    const auto leaves = std::ranges::max_element(waiting_, {}, [&](const FrameSet& s) { return least_served(s); });
    FrameSet left = std::move(*leaves);
    const auto later = waiting_.erase(leaves);
    for (CameraFrame& f : left.frames) {
      for (auto set = later; set != waiting_.end(); ++set) {
        const auto next = std::ranges::find(set->frames, f.camera, &CameraFrame::camera);
        if (next == set->frames.end()) continue;
        if (!next->patches) next->patches = std::move(f.patches);
        if (!next->descriptors) next->descriptors = std::move(f.descriptors);
        break;
      }
    }
    out.push_back(std::move(left));
  }
  return out;
}

std::optional<FrameSet> Backlog::pop() {
  if (waiting_.empty()) return std::nullopt;
  std::optional<FrameSet> next(std::move(waiting_.front()));
  waiting_.pop_front();
  for (const CameraFrame& f : next->frames) served_[f.camera] = {served(f.camera, next->t_ns) + 1, next->t_ns};
  return next;
}

double Backlog::served(CameraId camera, TimeNs now_ns) const {
  constexpr double kForgotten_s = 1;
  const auto at = served_.find(camera);
  if (at == served_.end()) return 0;
  return at->second.sets * std::exp(-to_seconds(now_ns - at->second.at_ns) / kForgotten_s);
}

double Backlog::least_served(const FrameSet& set) const {
  double least = std::numeric_limits<double>::infinity();
  for (const CameraFrame& f : set.frames) least = std::min(least, served(f.camera, waiting_.front().t_ns));
  return least;
}

}  // namespace coslam
