// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "agent/track/feature_tracker.h"

namespace coslam {

// Finds `count` tracks to do without, by index, descending: each the newest of where tracks stand closest once those
// before it are gone. Tracks in ascending id, of an image of this size; `count` may be negative.
std::vector<std::size_t> crowded_tracks(const std::vector<Track>& tracks, int image_cols, int image_rows, int count);

}  // namespace coslam
