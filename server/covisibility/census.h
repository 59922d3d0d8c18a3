// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "server/map/map.h"
#include "server/pipeline/stage.h"

namespace coslam {

struct CensusReport {
  int recent_points = 0;
  void count(auto&& add) const { add("recent_point_sets", recent_points); }
};

// Counts the points that were seen lately.
struct Census {
  static constexpr std::string_view kName = "census";
  using Config = NoConfig<Census>;
  Config config;
  CensusReport run(const Map& map) const { return {static_cast<int>(map.recent_points().size())}; }
};

}  // namespace coslam
