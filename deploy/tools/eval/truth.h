// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/dataset/sequence.h"
#include "common/dataset/trajectory.h"

namespace coslam::eval {

// The true poses of an agent's camera in the time that was played; empty where it has none. Forms, told apart by the
// lines of the file:
// - TUM, `t_s tx ty tz qx qy qz qw`, camera to world;
// - EuRoC's state_groundtruth_estimate0, `t_ns,x,y,z,qw,qx,qy,qz[,...]`, of the body: the camera's place on it is T_BS
// of
//   its calibration, an EuRoC sensor.yaml;
// - KITTI's poses, twelve numbers of [R t] a line, camera to world, one for each image.
// Times in UTC count from where the source's do. Throws UserError: what is wrong, with file and line.
Trajectory load_truth(const SequenceAgent& agent, double rate_hz);

// Why poses and truth have hardly an instant in common, one sentence for the user; empty where they have.
std::string times_apart(const std::string& agent, const Trajectory& poses, const Trajectory& truth);

}  // namespace coslam::eval
