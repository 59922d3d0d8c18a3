// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/stages/cull.h"

namespace coslam {
namespace {

constexpr std::size_t kMostPatches = 6;

// Keeps the first and newest patches: they come from the most different places.
void thin_patches(MapPoint& p) {
  while (p.patches.size() > kMostPatches) p.patches.erase(p.patches.begin() + 1);
}

bool is_false(const MapPoint& p, SetId now, const CullConfig& config) {
  if (!p.bound.empty() || p.created.value + static_cast<std::uint32_t>(config.probation_sets) > now.value) return false;
  return p.views < static_cast<std::uint32_t>(config.min_views);
}

}  // namespace

CullReport cull(Map& map, const FrameSet& set, const CullConfig& config) {
  CullReport report;
  std::vector<PointId> gone;
  for (auto& [id, p] : map.points()) {
    thin_patches(p);
    if (is_false(p, set.id, config)) gone.push_back(id);
  }
  for (const PointId id : gone) map.remove_point(id);
  report.removed = static_cast<int>(gone.size());
  return report;
}

}  // namespace coslam
