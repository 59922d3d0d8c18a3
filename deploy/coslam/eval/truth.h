// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/dataset/sequence.h"
#include "common/dataset/trajectory.h"

namespace coslam::eval {

// Order of the four numbers of a quaternion: that of the file's form, or with w at the other end.
enum class QuaternionOrder : std::uint8_t { kOfForm, kOther };

// The true poses of an agent's camera in the time that was played; empty where it has none. Forms, told apart by the
// lines of the file, between blanks, commas or semicolons; a first line of words is passed over:
// - TUM, `t_s tx ty tz qx qy qz qw`, camera to world; times may be nanoseconds;
// - EuRoC's state_groundtruth_estimate0, `t_ns,x,y,z,qw,qx,qy,qz[,...]`, of the body: the camera's place on it is T_BS
//   of its calibration, an EuRoC sensor.yaml;
// - KITTI's poses, twelve numbers of [R t] a line, or sixteen with 0 0 0 1, camera to world, one for each image, or
// with
//   the image's number before them.
// Times in UTC count from where the source's do. Throws UserError: what is wrong, with file and line.
Trajectory load_truth(const SequenceAgent& agent, double rate_hz, QuaternionOrder order = QuaternionOrder::kOfForm);

}  // namespace coslam::eval
