// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/geometry/triangulation.h"

// Tests the hypothesis that a thing is at rest by the views that one track has of it. Views have the poses of their
// frames, the newest first.
namespace coslam {

// Largest distance, in pixels, of a view from the best common direction of all: the miss of a thing that is infinitely
// far. Very large when that direction is behind a camera.
double far_miss_px(std::span<const View> views);

// Tells whether no static place explains the newest views up to so many pixels: neither the newest against some earlier
// ones, nor all of them together. frames: how many views before the newest count; nearest: least distance from the
// camera of a thing at rest.
bool moves_by_more(const std::vector<View>& views, std::size_t frames, double nearest, double most_px);

}  // namespace coslam
