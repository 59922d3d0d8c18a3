// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/wire_arguments.h"

namespace coslam {

void WireArguments::add_to(CLI::App& command) {
  command.add_option("--domain", domain, "DDS domain, 0 to 232")->type_name("N")->check(CLI::Range(0, 232));
  command.add_flag("--loopback", loopback, "look on this machine only, as for coslam run");
  command.add_option("--peer", peers, "host to ask by address or name; may be repeated")->type_name("HOST");
  command.add_option("--key", key_file, "file with the fleet's key, where it has one")->type_name("FILE");
  command.add_option("--config", config, "agent.yaml or server.yaml, which says the same")->type_name("FILE");
}

WireConfig WireArguments::over(WireConfig wire) const {
  if (loopback) {
    const std::string key = wire.key_file;
    wire = loopback_config(wire.domain);
    wire.key_file = key;
  }
  if (domain) wire.domain = *domain;
  if (!key_file.empty()) wire.key_file = key_file;
  return wire;
}

}  // namespace coslam
