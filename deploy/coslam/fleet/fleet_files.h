// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace coslam {

// A server and its agents, each on a machine of its own.
struct FleetPlan {
  std::vector<std::string> agents;
  std::string server;  // host of the server, which agents call; empty: they find each other by multicast
  int domain = 0;
};

struct FleetFile {
  std::filesystem::path name;  // in the fleet's folder
  std::string content;
  bool secret = false;  // for its owner's eyes only
};

// A key that nobody else has.
std::string draw_secret();

// Key, configurations, and what their services need beside the units that are installed. Throws UsageError: names that
// no agent may have, or that are there twice.
std::vector<FleetFile> fleet_files(const FleetPlan& plan, const std::string& secret);

// Throws UserError: a file is there already and may not be replaced, or cannot be written.
void write_files(const std::filesystem::path& folder, const std::vector<FleetFile>& files, bool replace);

// Commands to type next, as lines.
std::string next_commands(const FleetPlan& plan, const std::filesystem::path& folder);

}  // namespace coslam
