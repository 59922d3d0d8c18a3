// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/base/fields.h"
#include "server/estimator/map/keys.h"

namespace coslam {

// Relative pose of a camera to an earlier or another camera's frame of the same map that saw the same place.
struct LoopConstraint {
  CameraId camera, to_camera;
  SetId set, to_set;
  Rigid3 camera_from_to;  // translation in the unit of length around the frame at to_set
  double scale = 1;       // length in that unit of what has length 1 around the camera now
};
auto fields(Like<LoopConstraint> auto& l) {
  return std::tuple(kept("camera", l.camera), kept("to_camera", l.to_camera), kept("set", l.set),
                    kept("to_set", l.to_set), kept("camera_from_to", l.camera_from_to), kept("scale", l.scale));
}

// Closes a loop: corrects a drifted map so that the loop holds exactly (paper 6.2, step 2). Every pose of every camera
// since the map's first frame moves, the earlier constraints and the cameras that see each other now keep their
// relative poses, and the points go along and are triangulated anew. `together`: the cameras of the constrained one's
// group. False when there is no solution; the map is then as before.
bool close_loop(PlaceRecognitionEdit& edit, MapId map_id, const LoopConstraint& loop,
                const std::vector<LoopConstraint>& earlier, const std::vector<CameraId>& together);

}  // namespace coslam
