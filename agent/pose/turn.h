// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

namespace coslam {

// Unit directions of one thing in the camera frame, of an image and of a later one.
using DirectionPairs = std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>>;

// The rotation vector that most directions made from the one image to the other; those that did something else, of near
// or moving things, do not count in the end. Empty with too few of them.
std::optional<Eigen::Vector3d> common_turn_rad(DirectionPairs pairs);

}  // namespace coslam
