// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "agent/gpu/device.h"

namespace coslam {

// The first GPU of CUDA. Driver (libcuda) and compiler (libnvrtc, 11.2 or later) are looked for when this is called:
// nothing of CUDA is needed to build. Throws NoDevice, DeviceFailure.
std::unique_ptr<Device> cuda_device(const std::string& program);

}  // namespace coslam
