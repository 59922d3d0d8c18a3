// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "agent/gpu/device.h"
#include "agent/track/matcher.h"

namespace coslam {

struct DeviceMatcher {
  std::string device;  // name of the device
  std::unique_ptr<Matcher> matcher;
};

// Matches on a device that was made with match_program(). Each image and each first patch goes there once, and the
// sightings come back once; sums are the CPU's to the bit, places its to the rounding of a float. All calls of the
// matcher throw DeviceFailure; its before() and newest() are good after that, too.
DeviceMatcher device_matcher(std::unique_ptr<Device> device, const TrackerConfig& config);

}  // namespace coslam
