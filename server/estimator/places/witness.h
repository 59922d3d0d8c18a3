// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "server/estimator/places/key_image_database.h"

namespace coslam {

// Rotation, and logarithm of the scale, up to which two sights of one place say the same.
inline constexpr double kSameTurn_rad = 0.05, kSameScale = 0.15;
// Longest time between images that tell of one and the same meeting.
inline constexpr double kOneVisit_s = 5.0;

// Transform from a remembered image's map, or its part of one, to the map of the place that it shows again, by this
// image alone.
struct Witness {
  SetId set;
  CameraId camera;
  ImageKey place_image;  // key image that it is most like
  MapId into;            // map of the place
  Similarity3 into_from_own;
  double depth = 0;                                // median depth of the place's points
  Eigen::Vector3d center;                          // camera centre in its own map
  std::vector<std::pair<PointId, PointId>> pairs;  // point of the image, point of the place
};

// Computes a witness from a recognised place; empty when the depths of its points and the place's do not agree on one
// scale.
std::optional<Witness> witness_of(const Map& map, const LoopCandidate& seen);
// Inverts a witness: how the place's map lies to that of the image, `own`.
Witness reversed(const Witness& w, MapId own_map);
// Tells whether two witnesses agree that are not of one image, or of the same two images, each recognised in the other.
bool agree(const Witness& a, const Witness& b);

}  // namespace coslam
