// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "agent/agent_options.h"
#include "common/model/image_fault.h"
#include "deploy/coslam/doctor/finding.h"

// The cameras of this machine, and the source of an agent. Facts are looked up, judging them is pure.
namespace coslam::doctor {

struct VideoDevice {
  std::string path;
  std::string problem;  // why it cannot be opened; empty: it can
  bool forbidden = false;
  std::string name;                // as its driver says
  std::vector<std::string> modes;  // "MJPG up to 1920x1080"; empty: it takes no pictures
};
std::vector<VideoDevice> look_at_devices();
Findings judge(const std::vector<VideoDevice>& devices);

// What two seconds of a source were like.
struct SourceFacts {
  std::string name;
  std::string problem;              // why it cannot be read; empty: it can
  std::string doubt;                // of its calibration
  std::string calibration_problem;  // why that cannot be read; the rest is as without it
  bool live = false;
  int width_px = 0, height_px = 0;
  int images = 0;
  ImageFault fault = ImageFault::kNone;  // what most of them had
  int at_fault = 0;
  int dropped = 0;        // since tracking took too long
  double period_s = 0;    // from image to image, the usual
  double longest_s = 0;   // the longest
  double nominal_hz = 0;  // as the configuration has it
  double behind_s = 0;    // of the stamps of a live source, behind the clock of this machine
  double light = 0;       // mean of its grey values, 0 to 255
  double clipped = 0;     // share of them that is black or white
  double sharpness = 0;   // see sharpness_of()
  double track_s = 0;     // what an image takes, the usual
  int tracks = 0, most_tracks = 0;
};
SourceFacts look_at_source(const AgentOptions& settings);
Findings judge(const SourceFacts& facts);

}  // namespace coslam::doctor
