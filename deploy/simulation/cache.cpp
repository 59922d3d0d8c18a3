// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/base/cache_folder.h"
#include "common/base/error.h"
#include "deploy/simulation/scene.h"
#include "deploy/simulation/writer.h"

namespace coslam {
namespace {

namespace fs = std::filesystem;

fs::path cache_root() {
  if (auto folder = cache_folder()) return *folder;
  throw UserError("no place for rendered scenes: set COSLAM_CACHE or HOME");
}

bool is_complete(const fs::path& folder) { return fs::exists(folder / "sequence.yaml"); }

}  // namespace

fs::path cached_sequence(const RenderOptions& options, const std::function<void(int, int)>& progress) {
  // Named after the numbers that the scene has in the end, so that "3 cameras" and "the scene's own" share a folder.
  const auto scene = make_scene(options.scene, options.seed, options.cameras, options.frames);
  const std::string name = options.scene + "-s" + std::to_string(options.seed) + "-c" +
                           std::to_string(scene->cameras()) + "-f" + std::to_string(scene->frames()) + "-v" +
                           std::to_string(sim::kRendererVersion);
  fs::path folder = cache_root() / name;
  if (is_complete(folder)) return folder;
  try {
    render_sequence(options, folder, progress);
  } catch (const UserError&) {
    // Another process may have rendered the same in the meantime.
    if (!is_complete(folder)) throw;
  }
  return folder;
}

}  // namespace coslam
