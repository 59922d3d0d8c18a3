// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace coslam {

// Which camera of this machine, and how it is to be read.
struct CameraMode {
  std::string device;               // a number, or a file in /dev
  int width_px = 0, height_px = 0;  // 0: as the camera has it
  double rate_hz = 0;               // the same
  std::string format;               // four letters of V4L2: MJPG, YUYV; empty: the same
};

// Of v4l2:DEVICE[?size=WxH][&fps=N][&format=FOURCC]. Throws UserError, one sentence.
CameraMode parse_camera_mode(const std::string& uri);

}  // namespace coslam
