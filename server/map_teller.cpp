// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/map_teller.h"

#include <utility>

#include "common/flow/clock.h"
#include "server/server_loop.h"

namespace coslam {

MapTeller::MapTeller(ServerLoop& loop, std::vector<PublicSink*> sinks)
    : watch_(loop.map_server()), publication_(std::move(sinks)) {
  loop.observe(this);
}

void MapTeller::tell(Snapshot snapshot) {
  if (!snapshot.empty()) publication_.put(std::move(snapshot));
}

void MapTeller::after_set(const FrameSet& set, const ServerLoop& loop) {
  tell(watch_.after_set(set, loop.map_server(), publication_.wanted(), monotonic_now_ns(),
                        [&] { return loop.facts(); }));
}

void MapTeller::in_between(const ServerLoop& loop) {
  tell(watch_.in_between(loop.map_server(), publication_.wanted(), monotonic_now_ns(), [&] { return loop.facts(); }));
}

void MapTeller::finishing(const ServerLoop& loop) { finished(loop); }

void MapTeller::finished(const ServerLoop& loop) {
  tell(watch_.at_the_end(loop.map_server(), publication_.wanted(), monotonic_now_ns(), [&] { return loop.facts(); }));
}

}  // namespace coslam
