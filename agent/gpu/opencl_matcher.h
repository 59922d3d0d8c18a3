// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include "agent/track/matcher.h"

namespace coslam {

// A device cannot be used, or failed.
struct DeviceFailure : std::runtime_error {
  using runtime_error::runtime_error;
};
struct NoDevice : DeviceFailure {
  using DeviceFailure::DeviceFailure;
};

struct DeviceMatcher {
  std::string device;  // its name
  std::unique_ptr<Matcher> matcher;
};

// Matches on a device of OpenCL, a GPU if there is one, else another unless gpu_only. Each image goes there once, and
// the sightings come back once; sums are the CPU's to the bit, places its to the rounding of a float. This and all
// calls of the matcher throw DeviceFailure; its before() and newest() are good after that, too.
DeviceMatcher opencl_matcher(const TrackerConfig& config, bool gpu_only);

}  // namespace coslam
