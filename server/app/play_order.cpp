// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/play_order.h"

namespace coslam {

// Those that had nothing to play, as cameras have not, are no reason for a recording to begin in its middle.
void PlayOrder::joined(TimeNs now_ns) {
  constexpr double kBegun_s = 5;  // whoever plays has sent something by then
  if (ordered_ns_ && (plays_ || now_ns - *ordered_ns_ < to_ns(kBegun_s))) return;
  ordered_ns_.reset();
  newest_ns_ = now_ns;
}

bool PlayOrder::due(TimeNs now_ns) {
  if (ordered() || !newest_ns_ || now_ns - *newest_ns_ < to_ns(kGather_s)) return false;
  ordered_ns_ = now_ns;
  return true;
}

}  // namespace coslam
