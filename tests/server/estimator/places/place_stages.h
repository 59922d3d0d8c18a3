// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/covisibility/expected_overlap.h"
#include "server/estimator/places/descriptor_requests.h"
#include "server/estimator/places/place_recognition.h"

namespace coslam::test {

struct PlaceStagesReport : PlaceRecognitionReport, DescriptorRequestsReport {};

// The three stages that recognise places, one after another as in the pipeline.
struct PlaceStages {
  explicit PlaceStages(const PlaceRecognitionConfig& config = {}, const AskConfig& ask = {})
      : overlap(ExpectedOverlap::Config()), recognition(config), requests(ask) {}

  PlaceStagesReport run(PlaceRecognitionEdit& edit, const FrameSet& set, const ViewGraph& graph,
                        Workers& workers = Workers::alone()) {
    const ExpectedOverlapReport expected = overlap.run(edit.map(), set, {graph}, GroupingConfig());
    const PlaceRecognitionReport met =
        recognition.run(edit, set, {graph}, expected, LocaliseConfig(), requests.config, workers);
    return {met, requests.run(edit.map(), set, {graph}, expected, recognition, met)};
  }

  ExpectedOverlap overlap;
  PlaceRecognition recognition;
  DescriptorRequests requests;
};

}  // namespace coslam::test
