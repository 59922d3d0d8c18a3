// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "deploy/simulation/simulated_scene.h"

namespace coslam::sim {

// Raised whenever the pixels or the truth of a scene change: cached renderings of older versions are not used.
inline constexpr int kRendererVersion = 2;
inline constexpr int kDepthEvery = 10;  // frames with a depth image

struct WriteOptions {
  std::string name;  // name of the scene
  std::uint64_t seed = 1;
  int threads = 2;
  double coarseness = 1;  // > 1: coarser textures and shadows, for tests
};

// Renders the scene into `folder`, which must not exist or be empty. Throws UserError, and then leaves nothing behind.
void write_sequence(const SimulatedScene& scene, const WriteOptions& options, const std::filesystem::path& folder,
                    const std::function<void(int, int)>& progress);

}  // namespace coslam::sim
