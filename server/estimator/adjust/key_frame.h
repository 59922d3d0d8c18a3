// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/map/keys.h"

namespace coslam {

struct KeyFrameConfig {
  double drop = 0.30;   // of a camera's points since the last key frame (paper)
  double max_s = 0.67;  // while any camera moves
};

template <class V>
void describe(V& v, KeyFrameConfig& c) {
  v.field("keyframe_drop", c.drop, {0.01, 1}, "of a camera's points since the last key frame");
  v.field("max_s", c.max_s, {0.01, 1000}, "between key frames while a camera moves");
}

// Key frame when any camera lost 30 % of the points it had at its last one, or moved for long (paper 4). Where there
// are more than a few cameras, one of them needs a key frame all the time, and the others are spared until they do.
// Returns true when the set became one.
bool decide_key_frame(KeyFramesEdit& edit, const FrameSet& set, const KeyFrameConfig& config);

}  // namespace coslam
