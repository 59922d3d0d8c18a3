// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/model/image_fault.h"

namespace coslam {

struct Image {
  FrameId frame;
  TimeNs capture_ns = 0;  // played time for files: source time minus start_s
  cv::Mat grey;           // CV_8UC1; nobody writes to it any more; may be empty where there is a fault
  ImageFault fault = ImageFault::kNone;
  bool pattern_stays = false;  // a pattern that stays in the picture wherever the camera looks was found by then
  std::optional<Instant> available_since;  // when it was there, of feeds that keep time
  cv::Mat color;                           // CV_8UC3 as BGR; where it is asked for, and the source has it
};

}  // namespace coslam
