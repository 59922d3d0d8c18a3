// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "common/base/workers.h"
#include "server/estimator/correct/patch_writer.h"
#include "server/estimator/covisibility/grouping.h"
#include "server/estimator/pipeline/stage.h"
#include "server/estimator/reports/descriptor_requests_report.h"
#include "server/estimator/reports/scale_report.h"

namespace coslam {

struct Corrections {
  std::vector<MapPatch> patches;  // one per frame of the set, in its order
};

// Tells each agent of the set what changed for it.
class Correct {
 public:
  static constexpr std::string_view kName = "correct";
  using Config = CorrectConfig;
  explicit Correct(const CorrectConfig& stage_config) : config(stage_config) {}
  CorrectConfig config;

  Corrections run(CorrectEdit& edit, const FrameSet& set, const ServerRun& server,
                  const DescriptorRequestsReport& asked, const ScaleReport& scale, const ViewGraph& graph,
                  Workers& workers);
  // Answers a frame that came too late to be used.
  MapPatch acknowledge(const Map& map, CameraId camera, const TrackFrame& frame, const ServerRun& server);

 private:
  PatchWriter& writer_of(CameraId camera, const ServerRun& server);

  std::map<CameraId, PatchWriter> writers_;
};

}  // namespace coslam
