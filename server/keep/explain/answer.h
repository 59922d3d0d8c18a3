// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/dataset/result.h"

namespace coslam::explain {

struct Question {
  std::string kind;            // point, track or camera
  std::string id;              // number, AGENT/TRACK, AGENT
  std::optional<double> at_s;  // time in the run; absent: the whole life
};

struct Answer {
  std::string text;
  std::string caution;  // the file does not hold all that happened; empty: it does
};

// Throws UsageError for an id that is none, UserError for one that nothing is known of.
Answer answer(const ResultFolder& result, const Question& question);

}  // namespace coslam::explain
