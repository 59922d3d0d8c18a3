// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace coslam {

// Items that share a task on CUDA: GROUP in the program.
constexpr int kCudaGroup = 64;

// Machine code of a program for GPUs of a compute capability, 90 for 9.0. Needs libnvrtc alone, else throws NoDevice;
// throws DeviceFailure for a program that cannot be translated.
std::vector<char> cuda_machine_code(const std::string& program, int capability);

// Key that this machine code can be kept by: all of what it is made from.
std::string cuda_code_key(const std::string& program, int capability);

}  // namespace coslam
