// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include "deploy/coslam/doctor/finding.h"

namespace coslam::doctor {

// The first of the worst: what the report tells to see to first.
inline Finding first_of(const Findings& findings) {
  const auto worst = std::ranges::max_element(findings, {}, &Finding::grade);
  return worst == findings.end() ? Finding() : *worst;
}

MATCHER_P3(Says, grade, found, mend, "") {
  *result_listener << "grade " << static_cast<int>(arg.grade) << ", found '" << arg.found << "', mend '" << arg.mend
                   << "'";
  return arg.grade == grade && arg.found.find(found) != std::string::npos && arg.mend.find(mend) != std::string::npos;
}

}  // namespace coslam::doctor
