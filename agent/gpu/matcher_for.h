// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "agent/gpu/device_matcher.h"
#include "agent/track/matcher.h"

namespace coslam {

// Values of TrackerConfig::device; auto: a GPU where there is one, by CUDA or else OpenCL, else the CPU.
std::vector<std::string> tracker_devices();

// The matcher that config.device asks for. Throws UserError for a device that is named and cannot be used.
std::unique_ptr<Matcher> matcher_for(const TrackerConfig& config);

// Matches on the device, and on the CPU, after a warning, from the call on where the device fails.
std::unique_ptr<Matcher> with_fallback(DeviceMatcher device, const TrackerConfig& config);

}  // namespace coslam
