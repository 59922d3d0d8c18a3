// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// In place of opencl_matcher.cpp where it was built without OpenCL.
#include "agent/gpu/opencl_matcher.h"

namespace coslam {

DeviceMatcher opencl_matcher(const TrackerConfig& /*config*/, bool /*gpu_only*/) {
  throw NoDevice("this program was built without OpenCL");
}

}  // namespace coslam
