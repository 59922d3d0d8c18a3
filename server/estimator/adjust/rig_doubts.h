// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/estimator/map/map.h"

namespace coslam {

// Checks configured rigs against the images, as far as images can tell: not how far apart the cameras are.
class RigDoubts {
 public:
  // Tells whether two cameras of a rig, at one set of a map in which the rig does not hold them yet, lie about as the
  // rig says.
  bool agrees(const Map& map, const MapCamera& a, const MapCamera& b, const Rigid3& b_from_a);
  // Returns new findings since the last call, one sentence each, each once: rigs that the images contradicted for a
  // second, and rigs whose cameras are too far apart for metres.
  std::vector<std::string> take(const Map& map);

 private:
  std::map<std::pair<CameraId, CameraId>, SetId> against_since_;
  std::set<std::pair<CameraId, CameraId>> contradicted_;
  std::set<CameraId> measured_;
  std::vector<std::string> found_;
};

}  // namespace coslam
