// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <opencv2/core/mat.hpp>
#include <string>

#include "common/dataset/sequence.h"

namespace coslam {

// Turns the parts that agents found to move with their cameras into masks, so that the run can be repeated with them
// from its first image on.
class OwnBodies {
 public:
  explicit OwnBodies(Sequence* sequence) : sequence_(*sequence) {}

  // Reads the report of a run; true when an agent found something.
  bool improve(const std::filesystem::path& result);
  // Writes the masks into the folder of the next run, which goes by them.
  void write(const std::filesystem::path& result);

 private:
  Sequence& sequence_;
  std::map<std::string, cv::Mat> masks_;  // masks by agent, with what was masked before
};

}  // namespace coslam
