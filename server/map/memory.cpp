// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/map/memory.h"

namespace coslam {

MemoryUse memory_of(const Map& map) {
  MemoryUse use{{"poses", 0},   {"held_tracks", 0}, {"tracks", 0}, {"points", 0}, {"key_observations", 0},
                {"patches", 0}, {"paths", 0}};
  for (const MapCamera& c : map.cameras()) {
    use["poses"] += bytes_of(c.frames);
    for (const FramePose& f : c.frames) use["held_tracks"] += bytes_of(f.held);
    for (const auto& [id, t] : c.tracks) use["tracks"] += sizeof t + bytes_of(t.seen);
  }
  for (const auto& [id, p] : map.points()) {
    use["points"] += sizeof p + bytes_of(p.bound) + bytes_of(p.updated_from);
    use["key_observations"] += bytes_of(p.key_observations);
    use["patches"] += bytes_of(p.patches);
  }
  for (const auto& [id, samples] : map.motions()) {
    use["paths"] += bytes_of(samples);
    for (const MotionSample& s : samples) use["paths"] += bytes_of(s.seen);
  }
  return use;
}

}  // namespace coslam
