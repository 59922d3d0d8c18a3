// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/adjust/refine.h"

// Lenses as part of a bundle adjustment: what a calibration gets wrong, once the images say so.
namespace coslam {

// Standard deviations of what calibrations get wrong, by what they are worth: 0.5 % of the focal length, 0.5 % of the
// width, 0.02 of either distortion term, 0.2 % of the aspect.
Vector6d calibration_sigma(const CameraModel& camera);

// Solves for the lenses of all cameras in the job, too: its observations are by their calibrations then.
void free_lenses(const Map& map, RefineJob* job);

// Solves a job with free lenses. A lens that was as calibrated stays so unless it is found farther from that than
// chance would have it; then the others are solved for once more.
BundleResult solve_with_lenses(const RefineJob& job);

// What was found becomes the lenses of the cameras. How many changed.
int take_lenses(MapEdit& edit, const RefineJob& job, const BundleResult& result);

}  // namespace coslam
