// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/cull.h"

namespace coslam {

CullReport cull(CullEdit& edit, const FrameSet& set, const CullConfig& config) {
  CullReport report;
  edit.thin_patches(kPatchesOfPoint);
  const std::uint32_t probation = edit.map().sets_in(config.probation_s);
  // Of few images what is not seen again says little: it may have left the view.
  const double least_views = probation < kLeastFrames ? 0 : config.min_seen * probation;
  const std::set<PointId> loose = edit.map().untracked_points();
  for (const PointId id : loose) {
    const MapPoint& p = *edit.map().find(id);
    if (p.created.value + probation > set.id.value) continue;
    if (p.views < least_views) {
      edit.remove_point(p, Why::kSeenTooLittle,
                        {static_cast<double>(p.views), static_cast<double>(set.id.value - p.created.value)});
      ++report.removed;
    } else {
      edit.keep_untracked(id);
    }
  }
  return report;
}

}  // namespace coslam
