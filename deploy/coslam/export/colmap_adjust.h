// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "deploy/coslam/export/colmap_model.h"

namespace coslam::exporting {

// Bundle adjustment of the model by itself: its own images alone, all observations with one weight, lenses as they are.
// A result's poses are adjusted at key frames, robustly and with less weight for repeated views, and carried along
// between them, so what programs would make of these images differs a little. Observations that the solution does not
// fit lose their points; images and points of which too little is left go. The whole stays where it was.
void adjust_colmap_model(ColmapModel* model);

}  // namespace coslam::exporting
