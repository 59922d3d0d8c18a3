// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <optional>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/config/program.h"
#include "common/wire/ros_domain.h"
#include "server/show/bridge/bridge.h"

namespace coslam {
namespace {

struct Arguments {
  CommonArguments common;
  std::string key, px4;
  std::vector<std::string> interfaces;
  std::optional<int> domain, from;
  bool loopback = false;
};

void add_options(CLI::App& app, Arguments& a) {
  a.common.add_to(app, "bridge.yaml", "bridge.px4.pitch_deg=-30");
  app.add_option("--from", a.from, "DDS domain of the map server and its agents")
      ->type_name("N")
      ->check(CLI::Range(0, 232));
  app.add_option("--domain", a.domain, "DDS domain of the ROS 2 nodes (default: ROS_DOMAIN_ID, else 0)")
      ->type_name("N")
      ->check(CLI::Range(0, 232));
  app.add_option("--interface", a.interfaces, "address of this machine on which ROS 2 is spoken (default: 127.0.0.1)")
      ->type_name("ADDRESS");
  app.add_option("--key", a.key, "the fleet's key")->type_name("FILE");
  app.add_option("--px4", a.px4, "agent whose poses PX4 gets")->type_name("AGENT");
  app.add_flag("--loopback", a.loopback, "the map server is on this machine");
}

BridgeOptions options_of(const Arguments& a) {
  BridgeOptions o;
  if (a.loopback) o.wire = loopback_config(0);
  a.common.apply_to(o);
  if (a.from) o.wire.domain = *a.from;
  if (a.domain) o.bridge.domain = *a.domain;
  if (!a.key.empty()) o.wire.key_file = a.key;
  if (!a.px4.empty()) o.bridge.px4.agent = a.px4;
  if (!a.interfaces.empty()) o.bridge.interfaces = a.interfaces;
  return o;
}

// Until SIGINT or SIGTERM, which every thread leaves to this one.
void run(BridgeOptions options, const sigset_t& signals) {
  if (options.bridge.domain < 0) options.bridge.domain = ros_domain_id().value_or(0);
  const Bridge bridge(options);
  log_info("from DDS domain " + std::to_string(options.wire.domain) + " to ROS 2 in domain " +
           std::to_string(options.bridge.domain));
  int signal = 0;
  sigwait(&signals, &signal);
}

int main_of(int argc, char** argv) {
  CLI::App app{"Hands on what a CoSLAM map server knows to ROS 2 nodes and PX4", "coslam-bridge"};
  Arguments arguments;
  add_options(app, arguments);
  if (const auto code = parse_arguments(app, argc, argv)) return *code;
  init_log("bridge", arguments.common.log_format);
  const BridgeOptions options = options_of(arguments);
  if (arguments.common.print) {
    print_config("coslam-bridge", options);
    return 0;
  }
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  run(options, signals);
  return 0;
}

}  // namespace
}  // namespace coslam

int main(int argc, char** argv) {
  return coslam::run_program("coslam-bridge", [&] { return coslam::main_of(argc, argv); });
}
