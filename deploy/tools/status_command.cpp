// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

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
  StatusOptions options;
};

// In place of what stood there before, on a terminal.
void show(const std::string& text, bool in_place) {
  if (in_place) std::fputs("\x1b[H\x1b[2J", stdout);
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

int status(const StatusArguments& arguments) {
  WireConfig config = arguments.loopback ? loopback_config(arguments.domain) : WireConfig();
  config.domain = arguments.domain;
  config.key_file = arguments.key_file;
  if (!arguments.peers.empty()) config.peers = arguments.peers;
  const bool in_place = arguments.options.watch && !arguments.options.json && isatty(STDOUT_FILENO) == 1;
  listen_for_status(config, arguments.options, [&](const std::string& text) { show(text, in_place); });
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
  command->add_flag("--watch", arguments->options.watch, "again each second, until Ctrl-C");
  command->add_flag("--json", arguments->options.json, "for programs: a line each time");
  command->callback([arguments, &chosen] { chosen = [arguments] { return status(*arguments); }; });
}

}  // namespace coslam
