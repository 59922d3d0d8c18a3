// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/observe/track_store.h"

#include <algorithm>

namespace coslam {

void TrackStore::record(const TrackFrame& frame, const MapCamera& camera, const Map& map) {
  for (const auto& [id, track] : camera.tracks) {
    ResultTrackRow row{.frame = frame.frame, .t_ns = frame.capture_ns, .track = id, .point = track.point};
    row.raw_px = camera.raw_px(track.seen.back().undistorted_px.cast<double>());
    if (const MapPoint* p = map.find(track.point)) row.state = told_state(p->phase);
    if (!track.bound() && track.moves()) row.state = PointState::kDynamic;
    file_.write(row);
    if (!track.co_moving_since) continue;
    const FramePose* first_frame = camera.frame_at(*track.co_moving_since);
    if (first_frame == nullptr) continue;
    auto& spans = moved_[id];
    if (spans.empty() || spans.back().from_ns != first_frame->capture_ns) {
      spans.push_back({first_frame->capture_ns, frame.capture_ns});
    }
  }
}

bool TrackStore::moved_at(TrackId track, TimeNs t_ns) const {
  const auto moved = moved_.find(track);
  return moved != moved_.end() && std::ranges::any_of(moved->second, [&](const Span& span) {
           return t_ns >= span.from_ns && t_ns < span.until_ns;
         });
}

void TrackStore::mark_earlier_motion() const {
  if (moved_.empty()) return;
  TrackWriter marked(path_, OutputFile::Shows::kWhole);
  for_each_track_row(path_, [&](ResultTrackRow row) {
    if (moved_at(row.track, row.t_ns)) row.state = PointState::kDynamic;
    marked.write(row);
  });
  marked.close();
}

}  // namespace coslam
