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

// Who is to be examined: this machine with the settings that an agent or the server would have here.
struct Patient {
  AgentOptions settings;                // of a server, what it shares with an agent: `wire`
  Findings of_config = {};              // what reading the configuration told
  std::vector<std::string> named = {};  // hosts that are asked besides the peers of the settings
  std::string out = {};                 // where results are to go; empty: not looked at
};

// With --config; what cannot be read becomes a finding, and the rest keeps its defaults.
Patient patient_of(const std::string& config_file);

using Check = std::function<Findings(const Patient&)>;

// All that is looked at, in the order of the report.
const std::vector<Check>& checks();

}  // namespace coslam::doctor
