// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/workers.h"
#include "server/estimator/adjust/refine.h"
#include "server/estimator/map/keys.h"

namespace coslam {

struct RefineReport {
  bool applied = false;
  int poses = 0, points = 0, observations = 0, outliers = 0, lenses = 0;
  double lens_step2 = 0;  // see lens_step2()
  double sigma_px = 0;
};

// Applies a solution; frames between key frames are carried along, other points triangulated anew. A job of an older
// epoch (the map was merged meanwhile) is dropped.
RefineReport apply_refine(BundleEdit& edit, const RefineJob& job, const BundleResult& result,
                          Workers& workers = Workers::alone());

}  // namespace coslam
