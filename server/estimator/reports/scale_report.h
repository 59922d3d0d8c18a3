// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include "common/base/ids.h"

namespace coslam {

// Knowledge of the scale of the maps (server/estimator/adjust/scale.h) after one frame set.
struct ScaleReport {
  std::set<MapId> in_metres;        // maps whose lengths are metres
  int measured = 0, scaled = 0;     // tags, and maps scaled by them
  std::vector<std::string> doubts;  // warnings for the user, one sentence each, each once

  void count(auto&& add) const {
    add("tags_measured", measured);
    add("scaled_by_tags", scaled);
  }
};

}  // namespace coslam
