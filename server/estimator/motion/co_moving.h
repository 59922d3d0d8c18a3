// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "common/geometry/triangulation.h"
#include "server/estimator/map/map.h"
#include "server/estimator/motion/evidence.h"

// Tells which tracks see a thing that goes along with their camera, as the car ahead does. Views are those of one
// track, the newest first; median_depth is that of the static points in view, 0 = unknown.
namespace coslam {

// Way in the image, in pixels, of a thing at rest at the median depth, from the oldest to the newest view; 0 when the
// depth is unknown.
double parallax_px(std::span<const View> views, double median_depth);

// Tells of a track that moved before whether it now keeps its distance to the camera while others pass by: it goes
// along with the camera. A thing that stopped is at some place.
bool goes_on_with_camera(const ServerTrack& track, std::span<const View> views, double median_depth, double most_px);

// Finds since when a track that moves now had kept its distance, time after time without a break; empty: it had not.
std::optional<SetId> co_moving_since(const MapCamera& camera, const ServerTrack& track, double median_depth,
                                     const EvidenceConfig& config);

}  // namespace coslam
