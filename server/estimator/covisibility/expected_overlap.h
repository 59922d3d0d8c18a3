// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string_view>
#include <vector>

#include "server/estimator/covisibility/grouping.h"
#include "server/estimator/map/map.h"
#include "server/estimator/pipeline/stage.h"

namespace coslam {

// Cameras that should see what a camera sees, while nothing holds it to them.
struct ExpectedOverlapReport {
  std::map<CameraId, std::vector<CameraId>> cameras;
};

// Finds out, now and then, which cameras see the same according to the map, although too few shared points hold them to
// each other. Place recognition looks for shared points there.
class ExpectedOverlap {
 public:
  static constexpr std::string_view kName = "expected_overlap";
  using Config = NoConfig<ExpectedOverlap>;
  explicit ExpectedOverlap(const Config& stage_config) : config(stage_config) {}
  Config config;

  ExpectedOverlapReport run(const Map& map, const FrameSet& set, Last<ViewGraph> last, const GroupingConfig& group);

 private:
  ExpectedOverlapReport newest_;
};

}  // namespace coslam
