// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/replay_rate.h"
#include "common/base/text.h"
#include "deploy/coslam/commands.h"
#include "deploy/coslam/console.h"
#include "deploy/coslam/run/outcome.h"
#include "deploy/coslam/run/run.h"
#include "deploy/coslam/run/told.h"
#include "deploy/coslam/view_flag.h"
#include "server/app/recorded_config.h"
#include "server/app/server_loop.h"
#include "server/app/stop_signals.h"
#include "server/fleet/record/recorded_link.h"
#include "server/fleet/record/repeated_link.h"

namespace coslam {
namespace {

struct ReplayArguments {
  std::string recording;
  std::string out = "result";
  std::string rate = "max";
  bool force = false;
  std::string map;  // empty: none
  Repeats repeats;
  std::string view_port;  // empty: not shown
  std::vector<std::string> sets;
};

// Threads and open files of this process.
std::size_t entries_of(const char* folder) {
  return static_cast<std::size_t>(
      std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()));
}

double resident_mib() {
  std::ifstream statm("/proc/self/statm");
  double all = 0, resident = 0;
  statm >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1U << 20U);
}

// What a long run costs, a line of figures for each played minute.
class Costs {
 public:
  void show(TimeNs now_ns, const MapServer& server) {
    constexpr TimeNs kEvery_ns = 60'000'000'000;
    if (now_ns < next_ns_) return;
    next_ns_ = now_ns + kEvery_ns;
    if (!std::exchange(begun_, true)) {
      std::printf(
          "played_min,resident_mib,map_mib,cpu_ms_a_set,map_thread_ms_a_set,points,key_frames,frames,threads,files\n");
    }
    const DurationHistogram sets = stage_histogram(server, "frame_set");
    double map_mib = 0;
    for (const auto& [part, bytes] : server.memory()) map_mib += static_cast<double>(bytes) / (1U << 20U);
    std::size_t frames = 0;
    for (const MapCamera& c : server.map().cameras()) frames += c.frames.size();
    const double sum_ms = 1000.0 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
    const double n = std::max(1.0, static_cast<double>(sets.count() - count_));
    const double of_map_thread_ms = sets.mean_ms() * static_cast<double>(sets.count());
    std::printf("%.1f,%.1f,%.1f,%.2f,%.2f,%zu,%zu,%zu,%zu,%zu\n", to_seconds(now_ns) / 60, resident_mib(), map_mib,
                (sum_ms - sum_ms_) / n, (of_map_thread_ms - of_map_thread_ms_) / n, server.map().points().size(),
                server.map().key_frames().size(), frames, entries_of("/proc/self/task"), entries_of("/proc/self/fd"));
    std::fflush(stdout);
    sum_ms_ = sum_ms;
    of_map_thread_ms_ = of_map_thread_ms;
    count_ = sets.count();
  }

 private:
  static DurationHistogram stage_histogram(const MapServer& server, const char* stage) {
    const auto& stages = server.times().stages();
    const auto at = stages.find(stage);
    return at == stages.end() ? DurationHistogram() : at->second;
  }
  bool begun_ = false;
  TimeNs next_ns_ = 0;
  double sum_ms_ = 0, of_map_thread_ms_ = 0;
  std::uint64_t count_ = 0;
};

ViewConfig view_of(const ReplayArguments& arguments) {
  RunConfig config;
  if (!arguments.view_port.empty()) config::apply_set(config, "server.view.port=" + arguments.view_port);
  return config.view;
}

// The map server on agents that play what was recorded again and again.
void map_repeated(const ReplayArguments& arguments, const RecordedConfig& config, const ViewConfig& shown) {
  RepeatedLink link(arguments.recording, arguments.repeats);
  const ServerClock clock{[&link] { return link.monotonic_ns(); }, [&link] { return link.utc_ns(); }};
  // Poses that agents say are in the map of then: to another run they mean nothing.
  ServerLoop loop(link, RunId(link.head().server_run.value + 1),
                  {.server = config.server,
                   .result = {.folder = arguments.out, .runs = {}},
                   .map = arguments.map,
                   .refine_in_thread = false,
                   .clock = clock});
  const RunTold observers(shown, loop);
  Costs costs;
  while (!stop_requested() && !link.over() && loop.poll(std::chrono::milliseconds(20))) {
    costs.show(link.now_ns(), loop.map_server());
  }
  loop.finish(config::dump_json(config));
}

// The map server on what another one heard.
void map_recording(const ReplayArguments& arguments, const RecordedConfig& config, const ViewConfig& shown, double rate,
                   TimeNs length_ns) {
  RecordedLink link(arguments.recording, rate);
  const ServerClock clock{[&link] { return link.monotonic_ns(); }, [&link] { return link.utc_ns(); }};
  ProgressOfRun progress;
  ServerLoop loop(link, link.head().server_run,
                  {.server = config.server,
                   .expected_agents = config.agents,
                   .result = {.folder = arguments.out, .runs = {}},
                   .map = arguments.map,
                   .refine_in_thread = rate != 0,
                   .clock = clock,
                   .adjusting = [&](int percent) { progress.adjusting(percent); }});
  const RunTold observers(shown, loop);
  const auto whole_s = [](TimeNs t_ns) { return static_cast<int>(t_ns / 1'000'000'000); };
  while (!stop_requested() && !link.over() && loop.poll(std::chrono::milliseconds(20))) {
    progress.mapping(whole_s(std::min(link.now_ns(), length_ns)), whole_s(length_ns));
  }
  loop.finish(config::dump_json(config));
}

int replay(const ReplayArguments& arguments) {
  catch_stop_signals();
  const double rate = parse_replay_rate(arguments.rate);
  const ViewConfig shown = view_of(arguments);
  const RecordingSummary recorded = check_recording(arguments.recording);
  RecordedConfig config = recorded_config(recorded.head, arguments.recording);
  for (const std::string& s : arguments.sets) {
    if (s.starts_with("agent.")) {
      throw UsageError("--set " + s + ": agents are as they were recorded, only server.KEY can be set of a replay");
    }
    config::apply_set(config, s);
  }
  make_result_folder(arguments.out, arguments.force);
  if (recorded.cut_off) {
    log_warn(arguments.recording + " was cut off: what was recorded in its first " + format_seconds(recorded.t_ns) +
             " s is replayed");
  }
  if (arguments.repeats.times > 1 || arguments.repeats.fleets > 1) {
    if (rate != 0) throw UsageError("--times and --fleets play at --rate max only");
    map_repeated(arguments, config, shown);
  } else {
    map_recording(arguments, config, shown, rate, recorded.t_ns);
  }
  const bool mapped = print_summary(arguments.out);
  return mapped || stop_requested() ? 0 : 1;
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
  command->add_option("--map", arguments->map, "file to keep the map in; if there is one, it goes on")
      ->type_name("FILE");
  command
      ->add_option("--times", arguments->repeats.times,
                   "so many times, as agents that come again: a trial of hours. Says what each played minute costs")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--fleets", arguments->repeats.fleets, "so many of all recorded agents, one after the other")
      ->check(CLI::Range(1, 100));
  add_view_flag(*command, arguments->view_port);
  command->add_option("--set", arguments->sets, "override a recorded key of the configuration: server.KEY=VALUE");
  command->callback([arguments, &chosen] { chosen = [arguments] { return replay(*arguments); }; });
}

}  // namespace coslam
