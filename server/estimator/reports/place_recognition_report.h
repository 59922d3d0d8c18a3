// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/base/ids.h"

namespace coslam {

// Reason why nothing follows from a recognised place yet. kContradicted: another image said something else.
enum class PlaceDoubt : std::uint8_t { kNone, kTooFewFeatures, kFlat, kScalesDisagree, kUnconfirmed, kContradicted };
// Names of the counts of doubts, in the order of PlaceDoubt.
inline constexpr std::array kPlaceDoubtCounts{"",
                                              "places_in_too_few_features",
                                              "places_flat",
                                              "places_of_unclear_scale",
                                              "places_unconfirmed",
                                              "places_contradicted"};

// Result of place recognition (server/estimator/places) for one frame set.
struct PlaceRecognitionReport {
  std::vector<std::pair<SetId, CameraId>> described;  // images that came with descriptors
  std::vector<CameraId> hinted;  // cameras that may have recognised a place, in too few features to act on it
  int sightings = 0;             // known places recognised
  int placed = 0, merged = 0, closed = 0, linked = 0, expected = 0;
  std::array<int, kPlaceDoubtCounts.size()> doubts{};  // recognised places by PlaceDoubt
  MapId to_adjust;                                     // map that was joined or had a loop closed last; 0 = none
  SetId adjust_since;                                  // first set to adjust: older ones were in that map already

  void count(auto&& add) const {
    add("images_described", static_cast<long>(described.size()));
    add("sightings", sightings);
    add("placed", placed);
    add("merges", merged);
    add("loops_closed", closed);
    add("places_linked", linked);
    add("places_expected", expected);
    for (std::size_t i = 1; i < doubts.size(); ++i) add(kPlaceDoubtCounts[i], doubts[i]);
  }
};

}  // namespace coslam
