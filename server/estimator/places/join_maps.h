// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "server/estimator/map/keys.h"
#include "server/estimator/places/key_image_database.h"

namespace coslam {

// Two maps that became one.
struct JoinedMaps {
  MapId gone, kept;
  int images = 0, points = 0;  // by which that was told
  double scale = 1;            // lengths in the one that is kept, of those in the other
};

// Without any camera at work: maps from `first` on whose remembered images show a place of an older map become part of
// that one, by the points behind what looks alike. Two images of different instants have to agree, and what they show
// must not be flat, or ground that covers more than any print, if nearly all of them agree.
std::vector<JoinedMaps> join_maps(PlaceRecognitionEdit& edit, const KeyImageDatabase& places, MapId first);
// The same of each map with those that are older than it.
std::vector<JoinedMaps> join_all_maps(PlaceRecognitionEdit& edit, const KeyImageDatabase& places);

}  // namespace coslam
