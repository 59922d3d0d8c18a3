// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace coslam::doctor {

// Grades from good to bad.
enum class Grade : std::uint8_t { kOk, kWarn, kFail };

// Result of one check of this machine or the fleet.
struct Finding {
  Grade grade = Grade::kOk;
  std::string subject;  // subject of the check, in a word or two
  std::string found;
  std::string mend = {};  // a command or a key of the configuration; empty: nothing is to be mended
};

using Findings = std::vector<Finding>;

}  // namespace coslam::doctor
