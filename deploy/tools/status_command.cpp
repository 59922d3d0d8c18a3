// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "deploy/tools/commands.h"
#include "deploy/tools/status/listen.h"

namespace coslam {
namespace {

struct StatusArguments {
  int domain = 0;
  bool loopback = false;
  std::string key_file;
  std::vector<std::string> peers;
};

int status(const StatusArguments& arguments) {
  WireConfig config = arguments.loopback ? loopback_config(arguments.domain) : WireConfig();
  config.domain = arguments.domain;
  config.key_file = arguments.key_file;
  if (!arguments.peers.empty()) config.peers = arguments.peers;
  std::fputs(listen_for_status(config).c_str(), stdout);
  return 0;
}

}  // namespace

void add_status_command(CLI::App& app, Command& chosen) {
  auto arguments = std::make_shared<StatusArguments>();
  CLI::App* command =
      app.add_subcommand("status", "Tell who is alive in a DDS domain, after listening for two seconds");
  command->add_option("--domain", arguments->domain, "DDS domain, 0 to 232")
      ->check(CLI::Range(0, 232))
      ->capture_default_str();
  command->add_flag("--loopback", arguments->loopback, "look on this machine only, as for coslam run");
  command->add_option("--key", arguments->key_file, "file with the fleet's key, where it has one")->type_name("FILE");
  command
      ->add_option("--peer", arguments->peers, "host to call instead of multicast, by address or name; may be repeated")
      ->type_name("HOST");
  command->callback([arguments, &chosen] { chosen = [arguments] { return status(*arguments); }; });
}

}  // namespace coslam
