// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/base/fields.h"
#include "server/estimator/map/keys.h"

namespace coslam {

// Where one camera was, as another frame of the same map tells that saw the same place.
struct LoopConstraint {
  CameraId camera, to_camera;
  SetId set, to_set;
  Rigid3 camera_from_to;  // in the unit of length around the frame at to_set
  double scale = 1;       // lengths around the camera in that unit, for one as they are now
};
auto fields(Like<LoopConstraint> auto& l) {
  return std::tuple(kept("camera", l.camera), kept("to_camera", l.to_camera), kept("set", l.set),
                    kept("to_set", l.to_set), kept("camera_from_to", l.camera_from_to), kept("scale", l.scale));
}

// Draws a drifted map together so that the loop holds exactly (paper 6.2, step 2): every pose of every camera since
// the map's first frame moves, the earlier constraints and the cameras that see each other now keep their relative
// poses, and the points go along and are triangulated anew. `together`: the cameras of the constrained one's group.
// False when there is no solution; the map is then as before.
bool close_loop(PlaceRecognitionEdit& edit, MapId of, const LoopConstraint& loop,
                const std::vector<LoopConstraint>& earlier, const std::vector<CameraId>& together);

}  // namespace coslam
