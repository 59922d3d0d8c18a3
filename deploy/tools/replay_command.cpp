// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <memory>
#include <string>
#include <vector>

#include "common/base/log.h"
#include "common/base/replay_rate.h"
#include "common/base/text.h"
#include "deploy/tools/commands.h"
#include "deploy/tools/console.h"
#include "deploy/tools/run/outcome.h"
#include "server/record/recorded_link.h"
#include "server/recorded_config.h"
#include "server/server_loop.h"

namespace coslam {
namespace {

std::atomic<bool> stop_requested{false};

struct ReplayArguments {
  std::string recording;
  std::string out = "result";
  std::string rate = "max";
  bool force = false;
  std::vector<std::string> sets;
};

// The map server on what another one heard.
void map_recording(const ReplayArguments& arguments, const RecordedConfig& config, double rate, TimeNs length_ns) {
  RecordedLink link(arguments.recording, rate);
  const ServerClock clock{[&link] { return link.monotonic_ns(); }, [&link] { return link.utc_ns(); }};
  ServerLoop loop(link, link.head().server_run,
                  {.server = config.server,
                   .expected_agents = config.agents,
                   .out = arguments.out,
                   .refine_in_thread = rate != 0,
                   .clock = clock});
  const auto whole_s = [](TimeNs t_ns) { return static_cast<int>(t_ns / 1'000'000'000); };
  Progress progress("mapping");
  while (!stop_requested && !link.over() && loop.poll(std::chrono::milliseconds(20))) {
    progress(whole_s(std::min(link.now_ns(), length_ns)), whole_s(length_ns));
  }
  loop.finish(config::dump_json(config));
}

int replay(const ReplayArguments& arguments) {
  std::signal(SIGINT, [](int) { stop_requested = true; });
  std::signal(SIGTERM, [](int) { stop_requested = true; });
  const double rate = parse_replay_rate(arguments.rate);
  const RecordingSummary recorded = check_recording(arguments.recording);
  RecordedConfig config = recorded_config(recorded.head, arguments.recording);
  for (const std::string& s : arguments.sets) config::apply_set(config, s);
  make_result_folder(arguments.out, arguments.force);
  if (recorded.cut_off) {
    log_warn(arguments.recording + " was cut off: what was recorded in its first " + format_seconds(recorded.t_ns) +
             " s is replayed");
  }
  map_recording(arguments, config, rate, recorded.t_ns);
  print_summary(arguments.out);
  return 0;
}

}  // namespace

void add_replay_command(CLI::App& app, Command& chosen) {
  auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* command = app.add_subcommand("replay", "Build the map again from what a map server heard");
  command->add_option("RECORDING", arguments->recording, "file that --record of run or coslam-server wrote")
      ->required();
  command->add_option("--out", arguments->out, "RESULT folder")->capture_default_str();
  command->add_flag("--force", arguments->force, "replace the run that the folder holds");
  command->add_option("--rate", arguments->rate, "a factor of the recorded pace, or max (the same result every time)")
      ->capture_default_str();
  command->add_option("--set", arguments->sets, "override a recorded key of the configuration: server.KEY=VALUE");
  command->callback([arguments, &chosen] { chosen = [arguments] { return replay(*arguments); }; });
}

}  // namespace coslam
