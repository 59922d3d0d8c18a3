// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "common/base/ids.h"
#include "common/model/map_patch.h"

namespace coslam {

// Cameras that are asked for the descriptors of an image, and where in the image.
struct DescriptorRequestsReport {
  std::map<CameraId, DescriptorRequest> requests;
};

}  // namespace coslam
