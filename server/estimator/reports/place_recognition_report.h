// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "common/base/ids.h"
#include "common/model/map_patch.h"

namespace coslam {

// Result of place recognition (server/estimator/places) for one frame set.
struct PlaceRecognitionReport {
  int described = 0;  // images that came with descriptors
  int sightings = 0;  // known places recognised
  int placed = 0, merged = 0, closed = 0, linked = 0, expected = 0, doubted = 0;
  MapId to_adjust;     // map that was joined or had a loop closed last; 0 = none
  SetId adjust_since;  // first set to adjust: older ones were in that map already
  std::map<CameraId, DescriptorRequest> requests;

  void count(auto&& add) const {
    add("images_described", described);
    add("sightings", sightings);
    add("placed", placed);
    add("merges", merged);
    add("loops_closed", closed);
    add("places_linked", linked);
    add("places_expected", expected);
    add("meetings_doubted", doubted);
  }
};

}  // namespace coslam
