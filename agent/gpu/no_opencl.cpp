// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// In place of opencl.cpp where it was built without OpenCL.
#include "agent/gpu/opencl.h"

namespace coslam {

std::unique_ptr<Device> opencl_device(bool /*gpu_only*/, const std::string& /*program*/) {
  throw NoDevice("this program was built without OpenCL");
}

}  // namespace coslam
