// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/base/workers.h"
#include "server/estimator/associate/verify.h"
#include "server/estimator/map/keys.h"
#include "server/estimator/pipeline/stage.h"

namespace coslam {

struct RegisterReport {
  int candidates = 0, registered = 0;

  void count(auto&& add) const {
    add("register_candidates", candidates);
    add("registered", registered);
  }
};

// Matches unmapped tracks of each camera with active static points (paper 5.3): smallest Mahalanobis distance (8)
// within theta, patch correlation, and the gate at each view of the track in its last check_back_s. The point is then
// triangulated anew from its widest views.
RegisterReport register_tracks(RegisterEdit& edit, const FrameSet& set, Workers& workers = Workers::alone());

// Triangulates a point anew from all its key views and the newest view of each bound track: its position and
// covariance. Empty when its views do not determine it.
std::optional<PointEstimate> triangulated_anew(const Map& map, const MapPoint& point);
// Moves a point to its new triangulation. False: it stays as it is.
bool retriangulate(PointPositionEdit& edit, const MapPoint& point);

struct Register {
  static constexpr std::string_view kName = "register";
  using Config = NoConfig<Register>;
  Config config;
  RegisterReport run(RegisterEdit& edit, const FrameSet& set, Workers& workers) const {
    return register_tracks(edit, set, workers);
  }
};

}  // namespace coslam
