// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "server/estimator/map/keys.h"
#include "server/estimator/places/key_image_database.h"

namespace coslam {

// Two maps that became one.
struct JoinedMaps {
  MapId removed, remaining;
  int images = 0, points = 0;  // number of images and points that showed it
  double scale = 1;            // length in the remaining map of what has length 1 in the other
};

// Joins maps without any camera running: those from `first` on whose remembered images show a place of an older map
// become part of it, by the points behind what looks alike. Two images, recognised in different ones, have to agree,
// and what they show must not be flat, or else be ground that covers more than any print, if nearly all of them agree.
std::vector<JoinedMaps> join_maps(PlaceRecognitionEdit& edit, const KeyImageDatabase& places, MapId first);
// Joins each map to older ones whose places it shows, as join_maps() does.
std::vector<JoinedMaps> join_all_maps(PlaceRecognitionEdit& edit, const KeyImageDatabase& places);

}  // namespace coslam
