// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "deploy/simulation/mesh.h"

namespace coslam::sim {

// A thing of rigid parts that moves. The poses must be defined and smooth for every time, and the function thread-safe.
struct Body {
  std::vector<Mesh> parts;
  std::function<std::vector<Rigid3>(double t_s)> world_from_parts;
  std::string kind;
};

}  // namespace coslam::sim
