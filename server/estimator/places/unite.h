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

// What is done once a place is known to be the same.
namespace coslam {

// Tracks that matched a point of the place are bound to it, if they live; a point of their own becomes one with it.
void bind_matches(PlaceRecognitionEdit& edit, const DescribedImage& image,
                  const std::vector<std::pair<TrackId, PointId>>& matches);
// A camera without a map gets a pose in the place's, and before that as far back as it can be found.
void place(PlaceRecognitionEdit& edit, const DescribedImage& newest, const PlaceMatch& seen,
           const LocaliseConfig& config);
// The camera's map and the place's become one, in the frame of the larger. Since when the younger one was there.
SetId join(PlaceRecognitionEdit& edit, const DescribedImage& image, const PlaceMatch& seen,
           const Similarity3& in_from_own);
// The camera's map is drawn together; the loop then holds like the earlier ones. False when there is no solution.
bool close(PlaceRecognitionEdit& edit, const DescribedImage& image, const PlaceMatch& seen,
           const Similarity3& in_from_own, const ViewGraph& graph, std::vector<LoopConstraint>* loops);

}  // namespace coslam
