// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/model/track_frame.h"

namespace coslam {

// Frame of one camera, with what its agent sent along.
struct CameraFrame {
  CameraId camera;
  TrackFrame frame;
  std::optional<PatchReply> patches;
  std::optional<DescriptorReply> descriptors;
};

struct FrameSet {
  SetId id;
  TimeNs t_ns = 0;
  std::vector<CameraFrame> frames;  // sorted by camera, at most one each
};

}  // namespace coslam
