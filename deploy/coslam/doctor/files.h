// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "common/wire/wire_config.h"
#include "deploy/coslam/doctor/doctor.h"
#include "deploy/coslam/doctor/finding.h"

// The files that an agent or server is given: the reader of each says itself what is wrong with it.
namespace coslam::doctor {

// Reads a file for agents or the server into `settings`, a server's as far as it shares them.
Findings read_config(const std::string& file, AgentOptions& settings);

struct KeyFacts {
  std::string file;     // empty: none is given
  std::string problem;  // error of reading the key; empty: it is fit
  bool exists = false, open_to_others = false;
};
KeyFacts look_at_key(const WireConfig& wire);
Findings judge(const KeyFacts& facts);

}  // namespace coslam::doctor
