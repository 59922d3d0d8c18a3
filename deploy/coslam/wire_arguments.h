// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/wire/wire_config.h"

namespace coslam {

// Options that say where a command looks for the fleet.
struct WireArguments {
  std::optional<int> domain;
  bool loopback = false;
  std::vector<std::string> peers;
  std::string key_file;
  std::string config;  // agent.yaml or server.yaml

  void add_to(CLI::App& command);
  // Applies the options but --peer to the section `wire` of --config.
  WireConfig over(WireConfig wire) const;
};

}  // namespace coslam
