// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "common/dataset/sequence.h"

namespace coslam {

// Calibrations that are of another camera, or of another size of its images: a lens that has to change so much seldom
// arrives at the right one, while without any calibration it is found. Leaves those aside, for the run to be repeated.
class OtherLenses {
 public:
  explicit OtherLenses(Sequence* sequence) : sequence_(*sequence) {}

  // By the report of a run; true when one was left aside, with a warning.
  bool improve(const std::filesystem::path& result);

 private:
  Sequence& sequence_;
};

}  // namespace coslam
