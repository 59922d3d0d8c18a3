// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace coslam {

struct TrackerConfig {
  int max_tracks = 300;
  int levels = 5;                    // pyramid levels, level 0 included; the KLT window is 16 x 16 pixels of each
  double min_distance_px = 12;       // between a new corner and any live track, at 640 px width (scaled with width)
  double forward_backward_px = 0.5;  // largest return error
  double min_zncc = 0.75;            // ZNCC of a track's window with the one in the previous image, and with its first
  double min_eigenvalue = 1e-3;      // eigenvalue of the structure tensor, over that of the best recent corner
  int most_width_px = 1280;          // wider images are shrunk to that
  double border_px = 8;              // tracks end this close to the image border
  std::string device = "auto";       // device that works on the pixels, see agent/gpu/matcher_for.h
  std::string mask;                  // image of the camera's size, black where nothing is to be tracked; empty: none
};

}  // namespace coslam
