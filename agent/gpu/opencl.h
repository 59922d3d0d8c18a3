// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "agent/gpu/device.h"

namespace coslam {

// A device of OpenCL 1.2: a GPU if there is one, else another unless gpu_only. Throws NoDevice, DeviceFailure.
std::unique_ptr<Device> opencl_device(bool gpu_only, const std::string& program);

}  // namespace coslam
