// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "agent/agent_options.h"
#include "deploy/coslam/doctor/finding.h"

namespace coslam::doctor {

// The subject of the examination: this machine with the settings that an agent or the server would have here.
struct Patient {
  AgentOptions settings;                // settings of an agent; for a server only `wire`, which both share
  Findings of_config = {};              // findings from reading the configuration
  std::vector<std::string> named = {};  // hosts that are asked besides the peers of the settings
  std::string out = {};                 // folder for results; empty: not examined
};

// Reads the patient's settings from --config; what cannot be read becomes a finding, and the rest keeps its defaults.
Patient patient_of(const std::string& config_file);

using Check = std::function<Findings(const Patient&)>;

// All checks, in the order of the report.
const std::vector<Check>& checks();

}  // namespace coslam::doctor
