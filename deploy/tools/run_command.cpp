// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "agent/capture/source.h"
#include "common/base/error.h"
#include "common/base/replay_rate.h"
#include "common/base/text.h"
#include "common/config/config.h"
#include "common/dataset/calibration.h"
#include "common/dataset/result.h"
#include "deploy/tools/commands.h"
#include "deploy/tools/run/run.h"
#include "deploy/tools/sequence_argument.h"

namespace coslam {
namespace {

struct RunArguments {
  std::string sequence;
  std::string out = "result";
  std::vector<std::string> agents;
  CoverArguments covered;
  bool in_one_process = false, force = false;
  RunOptions options;
};

void select_agents(Sequence& sequence, const std::vector<std::string>& names) {
  if (names.empty()) return;
  std::vector<SequenceAgent> chosen;
  for (const std::string& name : names) {
    const auto at = std::find_if(sequence.agents.begin(), sequence.agents.end(),
                                 [&](const SequenceAgent& a) { return a.name == name; });
    if (at == sequence.agents.end()) throw UsageError("the sequence " + sequence.name + " has no agent " + name);
    chosen.push_back(*at);
  }
  // The known baseline is that of the sequence's own first two.
  const bool same_pair = chosen.size() >= 2 && sequence.agents.size() >= 2 &&
                         chosen[0].name == sequence.agents[0].name && chosen[1].name == sequence.agents[1].name;
  if (!same_pair) sequence.baseline_m.reset();
  std::erase_if(sequence.rigs, [&](const RigCamera& r) {
    const auto plays = [&](const std::string& name) {
      return std::ranges::any_of(chosen, [&](const SequenceAgent& a) { return a.name == name; });
    };
    return !plays(r.camera) || !plays(r.first);
  });
  sequence.agents = std::move(chosen);
}

void check_sets(const std::vector<std::string>& sets) {
  RunConfig checked;
  for (const std::string& s : sets) config::apply_set(checked, s);
}

// What the sequence knows of the scale: the distance of two cameras, or the side of tags, which the agents are to look
// for. --set goes before.
void know_scale(const Sequence& sequence, std::vector<std::string>& sets) {
  std::vector<std::string> known;
  if (sequence.baseline_m) known.push_back("server.baseline_m=" + format_double(*sequence.baseline_m));
  std::string rigs;
  for (const RigCamera& r : sequence.rigs) rigs += (rigs.empty() ? "" : ",") + text_of(r);
  if (!rigs.empty()) known.push_back("server.rigs=" + rigs);
  if (sequence.tag_m) {
    known.push_back("server.tag_m=" + format_double(*sequence.tag_m));
    known.push_back("agent.tags.family=" + sequence.tag_family);
  }
  sets.insert(sets.begin(), known.begin(), known.end());
  check_sets(sets);
}

// Opens everything once, so that bad input is one sentence before anything starts. Returns the number of frames of the
// longest.
int check_inputs(const Sequence& sequence) {
  int most = 0;
  for (const SequenceAgent& a : sequence.agents) {
    const CameraModel camera = load_calibration(a.calibration);
    const auto source = open_source(a.source, {a.start_s, a.duration_s, sequence.rate_hz, camera.width_px,
                                               camera.height_px, a.calibration.string()});
    int frames = 0;
    while (!source->live() && source->skip()) ++frames;
    most = std::max(most, frames);
  }
  return most;
}

// A folder holds one run.
void make_result_folder(const std::filesystem::path& folder, bool force) {
  const ResultFolder result(folder);
  if (result.holds_run()) {
    if (!force) {
      throw UserError(folder.string() +
                      " holds a run already: name another folder with --out, or replace it with --force");
    }
    result.remove_run();
  }
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && access(folder.c_str(), W_OK) != 0) error.assign(errno, std::generic_category());
  if (error) throw UserError("cannot make the result folder " + folder.string() + ": " + error.message());
}

double number(const nlohmann::json& j, const char* a, const char* b = nullptr, const char* c = nullptr) {
  const nlohmann::json* at = &j;
  for (const char* key : {a, b, c}) {
    if (key == nullptr) break;
    if (!at->contains(key)) return 0;
    at = &(*at)[key];
  }
  return at->is_number() ? at->get<double>() : 0;
}

void print_summary(const std::filesystem::path& out) {
  const nlohmann::json report = read_json(ResultFolder(out).report());
  std::printf("%-12s %7s %8s %9s %9s %10s %10s\n", "agent", "frames", "dropped", "tracked", "ms/frame", "kB/s up",
              "kB/s down");
  for (const auto& [name, a] : report["agents"].items()) {
    std::printf("%-12s %7.0f %8.0f %8.1f%% %9.1f %10.1f %10.1f\n", name.c_str(), number(a, "frames"),
                number(a, "dropped"), number(a, "tracked_percent"), number(a, "ms_per_frame"), number(a, "kb_per_s_up"),
                number(a, "kb_per_s_down"));
  }
  const auto& s = report["server"];
  if (number(s, "maps") > 1) {
    std::printf(
        "%.0f maps that never met; the summary and the files are of the largest, paths in the others are in %s\n",
        number(s, "maps"), (out / "trajectory" / "map<ID>").c_str());
  }
  std::printf("server: %.1f ms a frame set (p99 %.0f), %.0f static points, %.0f key frames, %.0f merges\nresult: %s\n",
              number(s, "ms", "frame_set", "mean"), number(s, "ms", "frame_set", "p99"), number(s, "points", "static"),
              number(s, "key_frames"), number(s, "merges"), out.c_str());
}

int run(RunArguments arguments) {
  RunOptions& options = arguments.options;
  parse_replay_rate(options.rate);  // a wrong one is said before anything starts
  check_sets(options.sets);
  options.sequence = sequence_argument(arguments.sequence);
  select_agents(options.sequence, arguments.agents);
  know_scale(options.sequence, options.sets);
  cover_lenses(options.sequence, arguments.covered);
  options.frame_sets = check_inputs(options.sequence);
  options.out = arguments.out;
  if (arguments.in_one_process && options.rate != "max") throw UsageError("--inline runs at --rate max only");
  make_result_folder(options.out, arguments.force);
  const int code = arguments.in_one_process ? run_inline(options) : run_processes(options);
  if (std::filesystem::exists(ResultFolder(options.out).report())) print_summary(options.out);
  return code;
}

}  // namespace

void add_run_command(CLI::App& app, Command& chosen) {
  auto arguments = std::make_shared<RunArguments>();
  RunOptions& options = arguments->options;
  CLI::App* command = app.add_subcommand("run", "Build one map from all cameras of a sequence");
  command->add_option("SEQUENCE", arguments->sequence, "a YAML file, a folder with sequence.yaml, or sim:NAME")
      ->required();
  command->add_option("--out", arguments->out, "RESULT folder")->capture_default_str();
  command->add_flag("--force", arguments->force, "replace the run that the folder holds");
  command->add_option("--agents", arguments->agents, "only these, in this order: a,b")->delimiter(',');
  add_cover_option(*command, arguments->covered);
  command->add_option("--rate", options.rate, "speed of replay: a factor of real time, or max (drops nothing)")
      ->capture_default_str();
  command->add_flag("--inline", arguments->in_one_process, "one process, same code");
  command->add_option("--domain", options.domain, "DDS domain, 0 to 232; default: one that depends on the process")
      ->check(CLI::Range(0, 232));
  command->add_option("--set", options.sets,
                      "override a key of the configuration: agent.KEY=VALUE or server.KEY=VALUE");
  command->callback([arguments, &chosen] { chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace coslam
