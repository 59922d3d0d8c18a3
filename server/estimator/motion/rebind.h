// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/map/keys.h"
#include "server/estimator/motion/follow.h"

namespace coslam {

// Binds free tracks that are where a moving point should appear, and look like it, to the point: so it keeps its id
// when a track ends, is hidden for a moment, or begins in another camera.
void rebind_moving(ClassifyEdit& edit, const FrameSet& set, const FollowConfig& config, FollowReport* report);

}  // namespace coslam
