// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace coslam::doctor {

// From good to bad.
enum class Grade : std::uint8_t { kOk, kWarn, kFail };

// What one look at this machine or the fleet told.
struct Finding {
  Grade grade = Grade::kOk;
  std::string subject;  // what was looked at, in a word or two
  std::string found;
  std::string mend = {};  // a command or a key of the configuration; empty: nothing is to be mended
};

using Findings = std::vector<Finding>;

}  // namespace coslam::doctor
