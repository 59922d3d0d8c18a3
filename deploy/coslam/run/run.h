// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "agent/agent_config.h"
#include "common/dataset/sequence.h"
#include "server/app/server_config.h"
#include "server/show/web/view_config.h"

namespace coslam {

struct RunOptions {
  Sequence sequence;  // the agents to run, in order
  std::filesystem::path out;
  std::filesystem::path record;  // empty: none
  std::filesystem::path map;     // empty: none
  std::string rate = "max";
  std::vector<std::string> sets;  // key=value, checked; the scale of the sequence among them
  int domain = -1;                // -1: one that depends on the process
  int frame_sets = 0;             // about how many there will be, for the progress bar
};

// Configuration that --set reaches: agent.* every agent, server.* the server.
struct RunConfig {
  AgentConfig agent;
  ServerConfig server;
  ViewConfig view;
};

template <class V>
void describe(V& v, RunConfig& c) {
  v.section("agent", c.agent);
  v.section("server", c.server);
  v.section("server.view", c.view);
}

struct RunEnd {
  int exit_code = 0;
  bool interrupted = false;  // the user stopped it, so only a part was played
};

// One server process and one agent process a camera, over DDS on this machine's loopback. The exit code is 1 when a
// process failed, with its sentence on stderr; the others go on and the result is written all the same.
RunEnd run_processes(const RunOptions& options);
// Says where the run is shown, for the user and for programs: a line on standard output, at once.
void say_view(const std::string& line);
// Runs the same code in this process, one thread, over a simulated link.
RunEnd run_inline(const RunOptions& options);

}  // namespace coslam
