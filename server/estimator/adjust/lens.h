// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/adjust/refine.h"
#include "server/estimator/map/keys.h"

// Lenses as part of a bundle adjustment: what a calibration gets wrong, once the images say so.
namespace coslam {

// Standard deviations of what calibrations get wrong, by what they are worth: 0.5 % of the focal length and of the
// width, 0.2 % of the aspect; along the radius 2 % at the corners, and half as much of each finer term.
LensCorrection::Values calibration_sigma(const CameraModel& camera);

// Solves for the lenses of all cameras in the job, too: its observations are by their calibrations then.
void free_lenses(const Map& map, RefineJob* job);

// Solves a job with free lenses. One that was as calibrated stays so unless the images say clearly that it is not; then
// all else is solved for once more.
BundleResult solve_with_lenses(const RefineJob& job);

// The problem from where its solution left it.
void go_on(const BundleResult& from, BundleProblem* problem);

// How far the lens that moved most is from where it was: squared, in standard deviations of where it is.
double lens_step2(const Map& map, const RefineJob& job, const BundleResult& result);
// From where on that is worth taking in, and from where on it tells that the next solution will move it again.
inline constexpr double kWorthTaking2 = 4, kOnItsWay2 = 100;

// Each lens of the solution is that of the camera by now, or can become it: else its poses and points are of no use.
bool lenses_may_be_taken(const Map& map, const RefineJob& job, const BundleResult& result);
// What was found becomes the lenses of the cameras. How many changed.
int take_lenses(BundleEdit& edit, const RefineJob& job, const BundleResult& result);

}  // namespace coslam
