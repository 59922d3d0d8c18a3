// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/adjust/refine.h"
#include "server/estimator/map/keys.h"

// Focus breathing: cameras whose focal length changes from image to image, because the lens keeps focusing.
namespace coslam {

// Solves again from a solution, with a zoom for each image, if the job asks for it. Used if it explains the images so
// much better that some camera must breathe; else the solution stays as it is, to the bit.
void solve_zooms(const RefineJob& job, BundleResult* result);

// Notes how much cameras breathe, and corrects their observations for it.
void apply_zooms(BundleEdit& edit, const RefineJob& job, const BundleResult& result);

}  // namespace coslam
