// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/doctor/files.h"

#include <sys/stat.h>

#include <filesystem>

#include "common/base/error.h"
#include "common/config/config.h"
#include "common/config/yaml_value.h"
#include "common/wire/guard.h"
#include "server/app/server_options.h"

namespace coslam::doctor {
namespace {

bool is_servers(const std::string& file) {
  const YamlValue top = YamlValue::load(file);
  return top.has("server") || top.has("agents");
}

}  // namespace

Findings read_config(const std::string& file, AgentOptions& settings) {
  const std::string subject = "config";
  try {
    const bool server = is_servers(file);
    if (server) {
      ServerOptions options{.wire = settings.wire};
      config::load(options, file);
      settings.wire = options.wire;
    } else {
      config::load(settings, file);
    }
    return {{Grade::kOk, subject, file + ": all its keys are known to " + (server ? "the server" : "agents")}};
  } catch (const UserError& error) {
    const bool exists = std::filesystem::is_regular_file(file);
    return {{Grade::kFail, subject, error.what(),
             exists ? "coslam-agent --print-config, or coslam-server, shows all keys" : "--config FILE with its path"}};
  }
}

KeyFacts look_at_key(const WireConfig& wire) {
  KeyFacts facts{.file = wire.key_file};
  if (facts.file.empty()) return facts;
  struct stat status {};
  facts.exists = stat(facts.file.c_str(), &status) == 0;
  facts.open_to_others = facts.exists && (status.st_mode & 077) != 0;
  try {
    load_fleet_key(facts.file, wire.domain);
  } catch (const UserError& error) {
    facts.problem = error.what();
  }
  return facts;
}

Findings judge(const KeyFacts& facts) {
  const std::string subject = "key file";
  if (facts.file.empty())
    return {{Grade::kOk, subject, "none: whoever reaches this network can join the fleet, see docs/security.md"}};
  if (facts.problem.empty()) return {{Grade::kOk, subject, facts.file + ": fit, and for its owner's eyes only"}};
  const std::string make = "head -c 32 /dev/urandom | base64 > " + facts.file + "; chmod 600 " + facts.file;
  const std::string mend = facts.open_to_others ? "chmod 600 " + facts.file
                           : facts.exists       ? make + " (the same file on all machines)"
                                                : "scp it from another machine of the fleet, or make one: " + make;
  return {{Grade::kFail, subject, facts.problem, mend}};
}

}  // namespace coslam::doctor
