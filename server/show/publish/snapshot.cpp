// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/snapshot.h"

#include <iterator>

namespace coslam {

void Snapshot::update(Snapshot newer) {
  constexpr std::size_t kMostEvents = 1000;  // when nobody takes them
  const auto take = [](auto& target, auto& source) {
    if (source) target = std::move(source);
  };
  take(poses, newer.poses);
  take(moving, newer.moving);
  take(cloud, newer.cloud);
  take(paths, newer.paths);
  take(tracks, newer.tracks);
  take(state, newer.state);
  events.insert(events.end(), std::make_move_iterator(newer.events.begin()),
                std::make_move_iterator(newer.events.end()));
  if (events.size() > kMostEvents) {
    events.erase(events.begin(), events.end() - static_cast<std::ptrdiff_t>(kMostEvents));
  }
}

}  // namespace coslam
