// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "common/dataset/sequence.h"

namespace coslam {

// Calibrations that are of another camera, or of another size of its images: a lens that has to change so much seldom
// arrives at the right one, while without any calibration it is found. Leaves those aside, for the run to be repeated,
// by the report of a run; true when there was one, with a warning.
bool leave_other_lenses(Sequence* sequence, const std::filesystem::path& result);

}  // namespace coslam
