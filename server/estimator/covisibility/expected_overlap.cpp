// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/covisibility/expected_overlap.h"

#include "server/estimator/covisibility/disjoint_sets.h"
#include "server/estimator/covisibility/overlap.h"

namespace coslam {

ExpectedOverlapReport ExpectedOverlap::run(const Map& map, const FrameSet& set, Last<ViewGraph> last,
                                           const GroupingConfig& group) {
  if (!map.every(map.config().match_period_s)) return newest_;
  newest_ = {};
  DisjointSets held(map.cameras().size());
  for (const ViewEdge& e : last.of.edges) {
    if (e.shared >= group.min_shared) held.unite(e.first.value, e.second.value);
  }
  ViewOverlap overlap(map);
  for (std::size_t i = 0; i < set.frames.size(); ++i) {
    for (std::size_t j = i + 1; j < set.frames.size(); ++j) {
      const CameraId a = set.frames[i].camera, b = set.frames[j].camera;
      if (held.find(a.value) == held.find(b.value)) continue;
      if (overlap.between(a, b).least() < group.min_overlap) continue;
      newest_.cameras[a].push_back(b);
      newest_.cameras[b].push_back(a);
    }
  }
  return newest_;
}

}  // namespace coslam
