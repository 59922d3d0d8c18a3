// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "common/geometry/camera_model.h"
#include "tests/support/temp_folder.h"

namespace coslam::test {

// A sequence of 320x240 pixels that takes a moment to make and that agents can track: cameras side by side that move
// along a wall with panels before it.
class SmallScene {
 public:
  static constexpr double kRate_hz = 30;
  static constexpr double kBaseline_m = 0.4000001;  // shows whether it arrives with all its digits

  // Longer than 30 frames: the cameras go back and forth.
  explicit SmallScene(int cameras = 2, int frames = 30, DistortionModel lens = DistortionModel::kNone,
                      const std::array<double, 8>& coefficients = {});

  std::string sequence() const { return (folder_ / "sequence.yaml").string(); }
  std::string source(int camera) const { return (folder_ / (name(camera) + ".csv")).string(); }
  std::string calibration() const { return (folder_ / "calibration.yaml").string(); }
  std::string image(int camera, int frame) const;
  static std::string name(int camera) { return "cam" + std::to_string(camera); }
  // Arguments of coslam-agent that plays what this camera sees.
  std::vector<std::string> agent(int camera, const std::string& domain, const std::string& rate = "max") const;
  const TempFolder& folder() const { return folder_; }

 private:
  TempFolder folder_;
};

}  // namespace coslam::test
