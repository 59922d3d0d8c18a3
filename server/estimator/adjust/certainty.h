// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "server/estimator/adjust/refine.h"
#include "server/estimator/map/keys.h"

// Covariances of points after an adjustment.
namespace coslam {

// Weight of each observation: views of a point by one track repeat its errors, drift on the surface above all, so that
// together they count as two, as in Map::covariance_of(). counts: which of the job's observations are views.
std::vector<double> worth_of_observations(const RefineJob& job, const std::vector<bool>& counts);

// Variance of the track error of each point, in units of what Map::covariance_of() assumes. Most corners hold to the
// noise of the image; those on edges and outlines slide, by ten times that. A point follows half of its tracks' slide:
// the other half is left in the residuals.
std::vector<double> track_variances(const Map& map, const RefineJob& job, const BundleResult& result);

// Expected error of a camera's path, from what its images leave open; in lengths of the map.
struct PathError {
  std::optional<double> sigma;  // RMS of its centres, apart from the map's frame and scale; empty: unknown
  double length = 0;            // length of the path, from key frame to key frame
};
using PathErrors = std::map<CameraId, PathError>;

// Sets the covariances of a solution's points: by the residuals of their own tracks, and with what uncertain poses add
// (point_uncertainty.h). Returns how uncertain the paths are.
PathErrors settle_covariances(PointPositionEdit& edit, const RefineJob& job, const BundleResult& result);

// Plans the path errors of a map while it grows: of its newest key frames, as many as fit; empty when there is too
// little. The job is to be given to path_errors(), in any thread.
std::optional<RefineJob> plan_path_errors(const Map& map, MapId map_id);
PathErrors path_errors(const RefineJob& job);

}  // namespace coslam
