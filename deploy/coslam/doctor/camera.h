// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
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
  std::string name;                // name that the driver gives
  std::vector<std::string> modes;  // "MJPG up to 1920x1080"; empty: it takes no pictures
};
std::vector<VideoDevice> look_at_devices();
Findings judge(const std::vector<VideoDevice>& devices);

// Facts from two seconds of a source.
struct SourceFacts {
  std::string name;
  std::string problem;              // why it cannot be read; empty: it can
  std::string doubt;                // doubt about its calibration
  std::string calibration_problem;  // why that cannot be read; the rest is as without it
  bool live = false;
  int width_px = 0, height_px = 0;
  int images = 0;
  ImageFault fault = ImageFault::kNone;  // most frequent fault
  int at_fault = 0;
  int dropped = 0;        // since tracking took too long
  double period_s = 0;    // usual interval from image to image
  double longest_s = 0;   // the longest
  double nominal_hz = 0;  // rate in the configuration
  double behind_s = 0;    // delay of a live source's stamps behind the clock of this machine
  double light = 0;       // mean of its grey values, 0 to 255
  double clipped = 0;     // share of them that is black or white
  double sharpness = 0;   // see sharpness_of()
  double track_s = 0;     // usual time of one tracking step
  int tracks = 0, most_tracks = 0;
};
// most: how long its images are looked at.
SourceFacts look_at_source(const AgentOptions& settings, std::chrono::milliseconds most = std::chrono::seconds(2));
Findings judge(const SourceFacts& facts);

}  // namespace coslam::doctor
