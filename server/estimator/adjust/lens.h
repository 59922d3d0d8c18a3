// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/adjust/refine.h"
#include "server/estimator/map/keys.h"

// Self-calibration as part of bundle adjustment: corrects lenses where the images show errors of their calibrations.
namespace coslam {

// Standard deviations of calibration errors, from experience: 0.5 % of the focal length and of the width, 0.2 % of the
// aspect; along the radius 2 % at the corners, and half as much of each finer term.
LensCorrection::Values calibration_sigma(const CameraModel& camera);

// Frees the lenses of all cameras in the job; its observations are then undistorted by the calibrations.
void free_lenses(const Map& map, RefineJob* job);

// Solves a job with free lenses. A lens that was as calibrated stays so unless the images clearly contradict it; then
// the rest is solved once more.
BundleResult solve_with_lenses(const RefineJob& job);

// Sets the problem's initial estimates from a solution.
void go_on(const BundleResult& from, BundleProblem* problem);

// Squared distance of the lens that moved most from its present correction, in standard deviations.
double lens_step2(const Map& map, const RefineJob& job, const BundleResult& result);
// Value of lens_step2() from which a solution's lenses are applied, and from which the next solution is expected to
// move them again.
inline constexpr double kWorthTaking2 = 4, kOnItsWay2 = 100;

// Tells whether each lens of the solution is that of its camera by now, or can become it: else its poses and points are
// of no use.
bool lenses_may_be_taken(const Map& map, const RefineJob& job, const BundleResult& result);
// Applies the solution's lenses to the cameras. Returns how many changed.
int take_lenses(BundleEdit& edit, const RefineJob& job, const BundleResult& result);

}  // namespace coslam
