// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/fleet/fleet_files.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <set>
#include <system_error>

#include "common/base/error.h"
#include "common/wire/codec.h"

namespace coslam {
namespace {

// Where the services look for them.
constexpr const char* kEtc = "/etc/coslam/";

std::string wire_section(const FleetPlan& plan, const std::vector<std::string>& peers) {
  std::string text = "wire:\n  domain: " + std::to_string(plan.domain) + "\n";
  if (!peers.empty()) text += "  peers: [" + peers.front() + "]\n";
  return text + "  key_file: " + kEtc + "fleet.key\n";
}

std::string server_yaml(const FleetPlan& plan) {
  return "# The map server of this fleet; coslam-server --print-config lists all keys.\n" + wire_section(plan, {});
}

std::string agent_yaml(const FleetPlan& plan, const std::string& agent) {
  std::vector<std::string> peers;
  if (!plan.server.empty()) peers.push_back(plan.server);
  return "# Agent " + agent + " of this fleet; coslam-agent --print-config lists all keys.\nid: \"" + agent +
         "\"\nsource: v4l2:0   # or ros2:/TOPIC, rtsp://..., gst:PIPELINE\ncalibration: \"\"  # absolute path; coslam "
         "calibrate makes one; empty: found out from the images\n" +
         wire_section(plan, peers);
}

// Services run as users without files of their own: the key is handed to them.
std::string with_key(const std::string& command) {
  return "[Service]\nLoadCredential=fleet.key:" + std::string(kEtc) + "fleet.key\nExecStart=\nExecStart=" + command +
         " --set wire.key_file=%d/fleet.key\n";
}

void write(const std::filesystem::path& path, const FleetFile& file) {
  const auto fail = [&] {
    throw UserError(path.string() + " cannot be written: " + std::generic_category().message(errno));
  };
  std::error_code error;
  std::filesystem::create_directories(path.parent_path(), error);
  const mode_t mode = file.secret ? 0600 : 0644;
  const int handle = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, mode);
  if (handle < 0) fail();
  const bool done = fchmod(handle, mode) == 0 && ::write(handle, file.content.data(), file.content.size()) ==
                                                     static_cast<ssize_t>(file.content.size());
  if (close(handle) != 0 || !done) fail();
}

// What has nothing in it that a shell or YAML would take apart.
bool is_host(const std::string& name) {
  return std::ranges::all_of(name,
                             [](unsigned char c) { return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '_'; });
}

}  // namespace

std::string draw_secret() {
  std::array<std::uint8_t, 32> octets{};
  if (getrandom(octets.data(), octets.size(), 0) != static_cast<ssize_t>(octets.size()))
    throw UserError("this machine has no random numbers for a key");
  std::string text;
  for (const std::uint8_t octet : octets) {
    std::array<char, 3> digits{};
    std::snprintf(digits.data(), digits.size(), "%02x", octet);
    text += digits.data();
  }
  return text + "\n";
}

std::vector<FleetFile> fleet_files(const FleetPlan& plan, const std::string& secret) {
  if (!is_host(plan.server)) throw UsageError("--server takes a name or an IPv4 address, not '" + plan.server + "'");
  std::set<std::string> names;
  for (const std::string& agent : plan.agents) {
    if (!valid_agent_name(agent))
      throw UsageError("'" + agent + "' is no name for an agent: up to 32 letters, digits, '_', '-' and '.'");
    if (!names.insert(agent).second) throw UsageError("agent '" + agent + "' is named twice");
  }
  std::vector<FleetFile> files{
      {"fleet.key", secret, true},
      {"server/server.yaml", server_yaml(plan)},
      {"server/coslam-server.service.d/fleet.conf",
       with_key("coslam-server --config %E/coslam/server.yaml --out %S/coslam-server/result --map "
                "%S/coslam-server/map")}};
  for (const std::string& agent : plan.agents) {
    const std::filesystem::path folder = std::filesystem::path("agents") / agent;
    files.push_back({folder / "agent.yaml", agent_yaml(plan, agent)});
    files.push_back(
        {folder / "coslam-agent.service.d/fleet.conf", with_key("coslam-agent --config %E/coslam/agent.yaml")});
  }
  return files;
}

void write_files(const std::filesystem::path& folder, const std::vector<FleetFile>& files, bool replace) {
  for (const FleetFile& file : files) {
    if (!replace && std::filesystem::exists(folder / file.name)) {
      throw UserError((folder / file.name).string() + " is there already; --force replaces it, the key too");
    }
  }
  for (const FleetFile& file : files) write(folder / file.name, file);
}

std::string next_commands(const FleetPlan& plan, const std::filesystem::path& folder) {
  std::string text;
  const auto machine = [&](const std::filesystem::path& part, const std::string& host, const std::string& service,
                           const std::string& config) {
    const std::string root = "root@" + host + ":";
    text +=
        "scp " + (folder / "fleet.key").string() + " " + (folder / part / config).string() + " " + root + kEtc + "\n";
    text += "scp -r " + (folder / part / (service + ".service.d")).string() + " " + root + "/etc/systemd/system/\n";
    text += "ssh root@" + host + " 'systemctl daemon-reload && systemctl enable --now " + service + "'\n";
  };
  machine("server", plan.server.empty() ? "SERVER" : plan.server, "coslam-server", "server.yaml");
  for (const std::string& agent : plan.agents) {
    machine(std::filesystem::path("agents") / agent, agent, "coslam-agent", "agent.yaml");
  }
  return text + "coslam doctor --domain " + std::to_string(plan.domain) + " --key " + (folder / "fleet.key").string() +
         "\n";
}

}  // namespace coslam
