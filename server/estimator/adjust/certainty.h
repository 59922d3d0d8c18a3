// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "server/estimator/adjust/refine.h"
#include "server/estimator/map/keys.h"

// What is known of points once they are adjusted.
namespace coslam {

// Views of a point by one track repeat what is wrong with it, its drift on the surface above all: together they are
// worth two, as in Map::covariance_of(). counts: which of the job's observations are views.
std::vector<double> worth_of_observations(const RefineJob& job, const std::vector<bool>& counts);

// How wrong the tracks of each point are, squared, in units of what Map::covariance_of() takes them to be. Most corners
// hold to the noise of the image; those on edges and outlines slide, by ten times that. A point goes along with half of
// what its tracks slide: the other half is left in the residuals.
std::vector<double> track_variances(const Map& map, const RefineJob& job, const BundleResult& result);

// How far a camera's path is off, to be expected from what its images leave open; lengths of the map.
struct PathError {
  std::optional<double> sigma;  // RMS of its centres, the map's frame and scale left aside; empty: nothing tells it
  double length = 0;            // of the path, from key frame to key frame
};
using PathErrors = std::map<CameraId, PathError>;

// Covariances of a solution's points: by how well their own tracks hold, and with what the uncertain poses add
// (point_uncertainty.h). How uncertain the paths themselves are.
PathErrors settle_covariances(PointPositionEdit& edit, const RefineJob& job, const BundleResult& result);

// The same of a map as it stands, while it grows: of its newest key frames, as many as fit; empty when there is too
// little. The job is to be given to path_errors(), anywhere.
std::optional<RefineJob> plan_path_errors(const Map& map, MapId of);
PathErrors path_errors(const RefineJob& job);

}  // namespace coslam
