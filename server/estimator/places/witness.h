// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "server/estimator/places/key_image_database.h"

namespace coslam {

// What one remembered image says of how its map, or its part of one, lies to the place that it shows again.
struct Witness {
  SetId set;
  CameraId camera;
  MapId into;  // that of the place
  Similarity3 into_from_own;
  double depth = 0;                                // of the place's points
  Eigen::Vector3d center;                          // of the camera, in its own map
  std::vector<std::pair<PointId, PointId>> pairs;  // own, of the place
};

// Nothing when its points and the place's do not tell one scale.
std::optional<Witness> witness_of(const Map& map, const LoopCandidate& seen);
// The same of how the place's map lies to that of the image, `own`.
Witness reversed(const Witness& w, MapId own);
// Whether two say the same, of different instants or of different cameras.
bool agree(const Witness& a, const Witness& b);

}  // namespace coslam
