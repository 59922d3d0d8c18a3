// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "agent/track/pyramid.h"

namespace coslam {

// Shift of the image content from one image to the next, as a whole, found by trying every shift of the coarsest level:
// it cannot be misled by a wrong start, and a fast turn of the camera is mostly a shift. Pixels of level 0.
Eigen::Vector2f global_shift(const Pyramid& from, const Pyramid& to);

}  // namespace coslam
