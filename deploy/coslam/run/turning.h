// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/dataset/trajectory.h"

namespace coslam {

// How much later the second camera's images were taken than they are dated, where both are held together: one rotation
// takes how the one turns to how the other does, at each instant, whatever the direction that each looks in and
// whichever map it is in. Empty: at no lag of up to ten seconds, or at several, or they hardly turn.
std::optional<double> lag_by_turning_s(const Trajectory& first, const Trajectory& second);

}  // namespace coslam
