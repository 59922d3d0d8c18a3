// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/show/publish/snapshot.h"

namespace coslam {

// The proven points of the main map as binary PLY: x, y, z, sqrt_trace_sigma (float), id (uint).
std::string ply_of(const PublicCloud& cloud);

}  // namespace coslam
