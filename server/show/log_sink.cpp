// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/log_sink.h"

#include "common/base/log.h"

namespace coslam {

void LogSink::see(const Snapshot& snapshot) {
  for (const PublicEvent& event : snapshot.events) {
    if (event.kind == "lost" || event.kind == "misdated") {
      log_warn(event.text);
    } else if (event.kind != "joined" && event.kind != "left" && event.kind != "restarted") {
      log_info(event.text);
    }
  }
}

}  // namespace coslam
