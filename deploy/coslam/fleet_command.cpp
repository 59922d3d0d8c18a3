// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <string>

#include "deploy/coslam/commands.h"
#include "deploy/coslam/fleet/fleet_files.h"

namespace coslam {
namespace {

struct FleetArguments {
  std::string folder;
  FleetPlan plan;
  bool force = false;
};

int init(const FleetArguments& arguments) {
  write_files(arguments.folder, fleet_files(arguments.plan, draw_secret()), arguments.force);
  std::printf("%s holds a key and the configurations. Fill in the sources of the agents, then, for each machine:\n%s",
              arguments.folder.c_str(), next_commands(arguments.plan, arguments.folder).c_str());
  return 0;
}

}  // namespace

void add_fleet_command(CLI::App& app, Command& chosen) {
  auto arguments = std::make_shared<FleetArguments>();
  CLI::App* fleet = app.add_subcommand("fleet", "Prepare the machines of a server and its agents");
  fleet->require_subcommand(1);
  CLI::App* command = fleet->add_subcommand(
      "init", "Make a key, configurations and what services need, and tell how they get to the machines");
  command->add_option("DIR", arguments->folder, "folder for them")->required();
  command->add_option("--agents", arguments->plan.agents, "names of the agents")
      ->delimiter(',')
      ->type_name("A,B,...")
      ->required();
  command->add_option("--server", arguments->plan.server, "host of the server, for agents to call by address or name")
      ->type_name("HOST");
  command->add_option("--domain", arguments->plan.domain, "DDS domain, 0 to 232")
      ->type_name("N")
      ->check(CLI::Range(0, 232))
      ->capture_default_str();
  command->add_flag("--force", arguments->force, "replace what is there, the key too");
  command->callback([arguments, &chosen] { chosen = [arguments] { return init(*arguments); }; });
}

}  // namespace coslam
