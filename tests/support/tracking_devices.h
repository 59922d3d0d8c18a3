// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "agent/gpu/cuda.h"
#include "agent/gpu/device_matcher.h"
#include "agent/gpu/match_program.h"
#include "agent/gpu/opencl.h"

namespace coslam::test {

// By "cuda" or "opencl", the latter on whatever it has. Throws NoDevice.
inline std::unique_ptr<Device> device_by(const std::string& interface) {
  const std::string program = match_program();
  return interface == "cuda" ? cuda_device(program) : opencl_device(false, program);
}
inline DeviceMatcher matcher_by(const std::string& interface, const TrackerConfig& config) {
  return device_matcher(device_by(interface), config);
}

}  // namespace coslam::test
