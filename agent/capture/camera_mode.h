// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace coslam {

// Selects a camera of this machine and the mode in which it is read.
struct CameraMode {
  std::string device;               // a number, or a file in /dev
  int width_px = 0, height_px = 0;  // 0: as the camera has it
  double rate_hz = 0;               // 0: as the camera has it
  std::string format;               // four letters of V4L2: MJPG, YUYV; empty: the same
};

// Parses v4l2:DEVICE[?size=WxH][&fps=N][&format=FOURCC]. Throws UserError, one sentence.
CameraMode parse_camera_mode(const std::string& uri);

}  // namespace coslam
