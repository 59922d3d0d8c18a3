// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/adjust/refine.h"
#include "server/estimator/map/keys.h"

// Cameras whose focal length changes from image to image, as of a lens that keeps focusing.
namespace coslam {

// Solves again from a solution, with a zoom for each image, where that is asked for. Taken where the images are
// explained so much better that some camera must breathe; elsewhere the solution stays as it is, to the bit.
void solve_zooms(const RefineJob& job, BundleResult* result);

// Notes how much cameras breathe, and brings what they observed to where it would be if they did not.
void apply_zooms(BundleEdit& edit, const RefineJob& job, const BundleResult& result);

}  // namespace coslam
