// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <thread>
#include <utility>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/text.h"
#include "common/base/words.h"
#include "common/wire/ports.h"
#include "deploy/coslam/console.h"
#include "deploy/coslam/run/child.h"
#include "deploy/coslam/run/run.h"

namespace coslam {
namespace {

std::atomic<int> interrupts{0};

void add_sets(const RunOptions& options, const std::string& prefix, std::vector<std::string>* command) {
  for (const std::string& s : options.sets) {
    if (s.starts_with(prefix)) command->insert(command->end(), {"--set", s});
  }
}

Child start_server(const RunOptions& options, int domain) {
  std::vector<std::string> names;
  for (const SequenceAgent& a : options.sequence.agents) names.push_back(a.name);
  std::vector<std::string> command{sibling_program("coslam-server"),
                                   "--loopback",
                                   "--domain",
                                   std::to_string(domain),
                                   "--result",
                                   options.out.string(),
                                   "--report-progress",
                                   "--set",
                                   "agents=" + joined(names, ",")};
  if (!options.map.empty()) command.insert(command.end(), {"--map", options.map.string()});
  if (!options.record.empty()) command.insert(command.end(), {"--record", options.record.string()});
  add_sets(options, "server.", &command);
  return Child("the map server", command);
}

Child start_agent(const RunOptions& options, const SequenceAgent& agent, int domain) {
  std::vector<std::string> command{sibling_program("coslam-agent"),
                                   "--loopback",
                                   "--domain",
                                   std::to_string(domain),
                                   "--id",
                                   agent.name,
                                   "--source",
                                   agent.source,
                                   "--rate",
                                   options.rate,
                                   "--start",
                                   format_double(agent.start_s)};
  if (options.sequence.rate_is_given) command.insert(command.end(), {"--fps", format_double(options.sequence.rate_hz)});
  if (!agent.calibration.empty()) command.insert(command.end(), {"--calibration", agent.calibration.string()});
  if (agent.duration_s) command.insert(command.end(), {"--duration", format_double(*agent.duration_s)});
  for (const TimeSpan& span : agent.covered) {
    command.insert(command.end(), {"--covered", format_double(span.from_s), format_double(span.to_s)});
  }
  add_sets(options, "agent.", &command);
  if (agent.mask) command.insert(command.end(), {"--mask", agent.mask->string()});
  return Child("agent " + agent.name, command);
}

bool port_is_free(int port) {
  const int s = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  const bool ok = s >= 0 && bind(s, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  if (s >= 0) ::close(s);
  return ok;
}

// A domain whose discovery port nobody holds, so that two runs on one machine do not meet. Domains up to 232 have ports
// below 65536.
int free_domain() {
  const int first = static_cast<int>(getpid() % 230);
  for (int i = 0; i < 230; ++i) {
    const int domain = 1 + (first + i) % 230;
    if (port_is_free(multicast_port(domain))) return domain;
  }
  throw UserError("every DDS domain from 1 to 230 is in use on this machine; name one with --domain");
}

// The children of one run, watched until the server has written its result.
class Supervisor {
 public:
  Supervisor(const RunOptions& options, int domain)
      : options_(options), domain_(domain), server_(start_server(options, domain)) {}

  int watch() {
    while (!server_.ended()) {
      read_progress();
      for (Child& a : agents_) {
        // Before the start the server would wait for it for ever.
        if (!a.ended() || a.problem().empty()) continue;
        read_progress();  // it may have started just now
        if (!started_ && !std::exchange(given_up_, true)) server_.interrupt();
      }
      if (interrupts > passed_on_) pass_on_interrupt();
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    read_progress();
    if (server_.problem().empty()) wait_for_agents();
    int code = server_.problem().empty() && started_ ? 0 : 1;
    for (Child& a : agents_) {
      if (!server_.problem().empty() || !a.ended()) a.kill();
      if (a.problem().empty()) continue;
      std::fprintf(stderr, "coslam run: %s%s\n", a.problem().c_str(),
                   started_ ? "; the others went on without it" : "");
      code = 1;
    }
    if (server_.killed()) std::fprintf(stderr, "coslam run: %s\n", server_.problem().c_str());
    if (server_.problem().empty() && !started_)
      std::fprintf(stderr, "coslam run: stopped before all agents were there\n");
    return code;
  }

 private:
  void read_progress() {
    for (const std::string& line : server_.lines()) {
      if (line == "ready" && !server_.ended()) start_agents();
      if (line == "started") started_ = true;
      if (line.starts_with("view: ")) say_view(line);
      int done = 0;
      const int all = options_.frame_sets;
      if (std::sscanf(line.c_str(), "progress %d", &done) == 1) progress_.mapping(std::min(done, all), all);
      if (std::sscanf(line.c_str(), "adjusting %d", &done) == 1) progress_.adjusting(done);
    }
  }
  // Not before: in the domain of another server they would meet that one.
  void start_agents() {
    const std::string number = std::to_string(domain_);
    log_info("the run is in DDS domain " + number + ": coslam status --loopback --domain " + number);
    for (const SequenceAgent& a : options_.sequence.agents) agents_.push_back(start_agent(options_, a, domain_));
  }
  void pass_on_interrupt() {
    ++passed_on_;
    server_.interrupt();
    for (const Child& a : agents_) a.interrupt();
  }
  void wait_for_agents() {
    for (int i = 0; i < 100; ++i) {
      bool all = true;
      for (Child& a : agents_) all &= a.ended();
      if (all) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  const RunOptions& options_;
  const int domain_;
  Child server_;
  std::vector<Child> agents_;
  ProgressOfRun progress_;
  bool started_ = false, given_up_ = false;
  int passed_on_ = 0;
};

}  // namespace

void say_view(const std::string& line) {
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

RunEnd run_processes(const RunOptions& options) {
  const int domain = options.domain >= 0 ? options.domain : free_domain();
  std::signal(SIGINT, [](int) { ++interrupts; });
  std::signal(SIGTERM, [](int) { ++interrupts; });
  Supervisor supervisor(options, domain);
  const int exit_code = supervisor.watch();
  return {exit_code, interrupts > 0};
}

}  // namespace coslam
