// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <opencv2/core/mat.hpp>
#include <string>

#include "common/dataset/sequence.h"

namespace coslam {

// What agents found to move with their cameras becomes a mask of theirs, for the run to be repeated with it from its
// first image on.
class OwnBodies {
 public:
  explicit OwnBodies(Sequence* sequence) : sequence_(*sequence) {}

  // By the report of a run; true when one found something.
  bool improve(const std::filesystem::path& result);
  // Writes the masks into the folder of the next run, which goes by them.
  void write(const std::filesystem::path& result);

 private:
  Sequence& sequence_;
  std::map<std::string, cv::Mat> masks_;  // by agent, what was masked before included
};

}  // namespace coslam
