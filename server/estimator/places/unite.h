// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "server/estimator/covisibility/grouping.h"
#include "server/estimator/map/keys.h"
#include "server/estimator/places/close_loop.h"
#include "server/estimator/places/key_image_database.h"
#include "server/estimator/pose/localise.h"

// Changes to the map once a place is known to be the same.
namespace coslam {

// Binds tracks that matched a point of the place to it, if they live, and fuses their points with it.
void bind_matches(PlaceRecognitionEdit& edit, const DescribedImage& image,
                  const std::vector<std::pair<TrackId, PointId>>& matches);
// Places a camera without a map: it gets a pose in the place's map, and before that as far back as one can be found.
void place(PlaceRecognitionEdit& edit, const DescribedImage& newest, const PlaceMatch& seen,
           const LocaliseConfig& config);
// Joins the camera's map and the place's, in the frame of a metric one, else of the larger. Returns the first set of
// the younger one.
SetId join(PlaceRecognitionEdit& edit, const DescribedImage& image, const PlaceMatch& seen,
           const Similarity3& in_from_own);
// Closes a loop of the camera's map, which is then added to `loops`. False when there is no solution.
bool close(PlaceRecognitionEdit& edit, const DescribedImage& image, const PlaceMatch& seen,
           const Similarity3& in_from_own, const ViewGraph& graph, std::vector<LoopConstraint>* loops);

}  // namespace coslam
