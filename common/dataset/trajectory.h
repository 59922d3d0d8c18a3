// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "common/base/time.h"
#include "common/dataset/result_folder.h"
#include "common/geometry/rigid3.h"

namespace coslam {

struct StampedPose {
  TimeNs t_ns = 0;
  Rigid3 cam_from_world;
};

// Ascending time. On disk: TUM lines `t_s tx ty tz qx qy qz qw`, camera to world.
using Trajectory = std::vector<StampedPose>;

Trajectory load_tum(const std::filesystem::path& file);  // throws UserError with file and line
// The file is there whole or as it was before. Throws UserError.
void save_tum(const std::filesystem::path& file, const Trajectory& trajectory, LengthUnit unit = LengthUnit::kNotTold);

// The pose at t_ns: the stamped one, or interpolated between two neighbours at most max_gap_ns apart; empty outside.
std::optional<Rigid3> pose_at(const Trajectory& trajectory, TimeNs t_ns, TimeNs max_gap_ns);

}  // namespace coslam
