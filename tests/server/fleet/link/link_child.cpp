// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// One end of a link in a process of its own, for tests that kill it:
//   link_child agent DOMAIN NAME RUN    plays frames in lock-step until it is killed
//   link_child server DOMAIN RUN        answers every frame until it is killed
#include <chrono>
#include <cstdlib>
#include <string>
#include <vector>

#include "agent/link/dds_agent_link.h"
#include "common/wire/participant.h"
#include "tests/server/fleet/link/echo_server.h"
#include "tests/support/wire_values.h"

using namespace std::chrono_literals;

namespace coslam {
namespace {

[[noreturn]] void run_end(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const WireConfig config = loopback_config(std::stoi(arguments.at(1)));
  if (arguments[0] == "server") {
    test::EchoServer server(config, RunId(std::stoull(arguments.at(2))));
    while (true) server.serve(1s);
  }
  const std::string name = arguments.at(2);
  const RunId run(std::stoull(arguments.at(3)));
  test::WireValues values(run.value);
  const auto link = open_agent_link(config, values.hello(name, run));
  for (std::uint32_t i = 0;; ++i) {
    link->send(values.frame(name, run, i), {}, {});
    while (link->wait_patch(FrameId(i), 60s)) {
    }
  }
}

}  // namespace
}  // namespace coslam

int main(int argc, char** argv) { coslam::run_end(argc, argv); }
