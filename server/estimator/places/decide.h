// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "server/estimator/covisibility/grouping.h"
#include "server/estimator/map/map.h"
#include "server/estimator/places/confirm.h"
#include "server/estimator/places/key_image_database.h"

namespace coslam {

struct DecideConfig {
  int min_place_inliers = 20;  // to place a camera that has no map
  int min_merge_inliers = 25;  // to join two maps, or to draw one together
};

// What is to be done about a place that a camera saw.
struct PlaceDecision {
  enum class What : std::uint8_t {
    kUnknown,         // nothing was recognised
    kSeenAsExpected,  // points of other cameras, found where they should appear: bind
    kTooFew,          // recognised in too few features: look again, more closely
    kDoubtful,        // flat, of an unknown scale, or not confirmed yet
    kPlace,           // the camera, which has no map, in the place's
    kLink,            // known points where the camera's pose expects them: bind
    kJoin,            // two maps
    kClose,           // a loop of the camera's map
  };
  using enum What;
  What what = kUnknown;
  PlaceMatch seen;          // of kSeenAsExpected the matches alone
  Similarity3 in_from_own;  // of kJoin and kClose: from the camera's map as it is now
};

// The one that decides whether what a camera recognised is the same place, and what follows from that. Before anything
// moves another image has to confirm it.
class PlaceJudge {
 public:
  explicit PlaceJudge(const DecideConfig& config) : config_(config) {}
  // seen: by appearance; expected: by the camera's pose.
  PlaceDecision decide(const Map& map, const DescribedImage& image, std::optional<PlaceMatch> seen,
                       ExpectedPlace expected, const ViewGraph& graph);
  // See Verification.
  void drawn_together(MapId map) { verification_.drawn_together(map); }
  void joined(MapId one, MapId other) { verification_.joined(one, other); }
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
