// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "server/estimator/covisibility/grouping.h"
#include "server/estimator/map/map.h"
#include "server/estimator/places/confirm.h"
#include "server/estimator/places/key_image_database.h"
#include "server/estimator/reports/place_recognition_report.h"

namespace coslam {

struct DecideConfig {
  int min_place_inliers = 20;  // least points to place a camera that has no map
  int min_merge_inliers = 25;  // least points to join two maps, or to close a loop
};

// Decision about a place that a camera recognised.
struct PlaceDecision {
  enum class Action : std::uint8_t {
    kUnknown,         // no known place
    kSeenAsExpected,  // points of other cameras, found where they should appear: bind
    kTooFew,          // recognised in too few features: look again, more closely
    kDoubtful,        // flat, of an unknown scale, or not confirmed yet
    kPlace,           // place the camera, which has no map, in that of the place
    kLink,            // known points are where the camera's pose expects them: bind
    kJoin,            // join two maps
    kClose,           // close a loop of the camera's map
  };
  using enum Action;
  Action action = kUnknown;
  PlaceMatch seen;                       // for kSeenAsExpected with matches alone
  Similarity3 in_from_own;               // transform from the camera's map as it is now, for kJoin and kClose
  PlaceDoubt doubt = PlaceDoubt::kNone;  // for kTooFew and kDoubtful
};

// Decides whether what a camera recognised is the same place, and what follows from that. Before anything moves another
// image has to confirm it.
class PlaceJudge {
 public:
  explicit PlaceJudge(const DecideConfig& config) : config_(config) {}
  // Decides about the places that an image shows; seen: found by appearance; expected: found by the camera's pose.
  PlaceDecision decide(const Map& map, const DescribedImage& image, std::optional<PlaceMatch> seen,
                       ExpectedPlace expected, const ViewGraph& graph);
  // Drops hypotheses within a map, after a loop of it was closed; and all of two maps, after they were joined.
  void drawn_together(MapId map) { verification_.drawn_together(map); }
  void joined(MapId one, MapId other) { verification_.joined(one, other); }
  // Type of evidence that a camera could add to a hypothesis.
  Verification::Waiting waiting(const Map& map, CameraId camera) const { return verification_.waiting(map, camera); }
  // Known points this close to where they are expected need no correction of poses.
  static double slack_px(const Map& map, const MapCamera& camera) {
    return map.config().theta * map.gate_sigma_px(camera);
  }

 private:
  DecideConfig config_;
  Verification verification_;
};

}  // namespace coslam
