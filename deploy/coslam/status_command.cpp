// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cstdio>
#include <memory>
#include <string>

#include "common/base/error.h"
#include "deploy/coslam/commands.h"
#include "deploy/coslam/doctor/doctor.h"
#include "deploy/coslam/status/listen.h"
#include "deploy/coslam/wire_arguments.h"

namespace coslam {
namespace {

struct StatusArguments {
  WireArguments wire;
  StatusOptions options;
};

// In place of what stood there before, on a terminal.
void show(const std::string& text, bool in_place) {
  if (in_place) std::fputs("\x1b[H\x1b[2J", stdout);
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

int status(const StatusArguments& arguments) {
  const doctor::Patient patient = doctor::patient_of(arguments.wire.config);
  for (const doctor::Finding& finding : patient.of_config) {
    if (finding.grade == doctor::Grade::kFail) throw UserError(finding.found);
  }
  WireConfig config = arguments.wire.over(patient.settings.wire);
  if (!arguments.wire.peers.empty()) config.peers = arguments.wire.peers;
  const bool in_place = arguments.options.watch && !arguments.options.json && isatty(STDOUT_FILENO) == 1;
  listen_for_status(config, arguments.options, [&](const std::string& text) { show(text, in_place); });
  return 0;
}

}  // namespace

void add_status_command(CLI::App& app, Command& chosen) {
  auto arguments = std::make_shared<StatusArguments>();
  CLI::App* command =
      app.add_subcommand("status", "Tell who is alive in a DDS domain, after listening for two seconds");
  arguments->wire.add_to(*command);
  command->add_flag("--watch", arguments->options.watch, "again each second, until Ctrl-C");
  command->add_flag("--json", arguments->options.json, "for programs: a line each time");
  command->callback([arguments, &chosen] { chosen = [arguments] { return status(*arguments); }; });
}

}  // namespace coslam
