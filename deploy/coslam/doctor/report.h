// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "deploy/coslam/doctor/finding.h"

namespace coslam::doctor {

Grade worst_of(const Findings& findings);

// A line each, and last how many are not fine and which of them to see to first.
std::string text_of(const Findings& findings);
// {"verdict": "ok", "findings": [{"grade": "ok", "subject": ..., "found": ..., "mend": ...}]}
std::string json_of(const Findings& findings);

}  // namespace coslam::doctor
