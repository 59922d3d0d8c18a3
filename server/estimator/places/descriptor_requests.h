// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "server/estimator/covisibility/expected_overlap.h"
#include "server/estimator/pipeline/stage.h"
#include "server/estimator/places/ask.h"
#include "server/estimator/places/place_recognition.h"
#include "server/estimator/reports/descriptor_requests_report.h"

namespace coslam {

// Asks cameras for the descriptors of an image, by what place recognition waits for and what the uplink has room for.
class DescriptorRequests {
 public:
  static constexpr std::string_view kName = "descriptor_requests";
  using Config = AskConfig;
  explicit DescriptorRequests(const AskConfig& stage_config) : config(stage_config), asking_(stage_config) {}
  AskConfig config;

  DescriptorRequestsReport run(const Map& map, const FrameSet& set, Last<ViewGraph> last,
                               const ExpectedOverlapReport& expected, const PlaceRecognition& places,
                               const PlaceRecognitionReport& met);

 private:
  Asking asking_;
};

}  // namespace coslam
