// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "common/geometry/camera_model.h"

namespace coslam {

// Reason why a calibration is unlikely, though a camera can be made of it.
struct CalibrationDoubt {
  std::string text;                // a sentence with the slip that it may come from; empty: no doubt
  bool hopeless = false;           // no lens is like that: who knows nothing of the lens is better off
  std::optional<double> focal_px;  // focal length that may be right nevertheless
};

// part: its image is a region of interest, in which the principal point may lie anywhere.
CalibrationDoubt doubt_of(const CameraModel& camera, bool part);

// Why there is no such camera in pixels, one sentence, or empty. Of a camera that problem_of() has nothing against.
std::string unit_problem_of(const CameraModel& camera);

}  // namespace coslam
