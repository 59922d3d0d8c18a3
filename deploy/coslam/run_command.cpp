// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "agent/capture/camera_of.h"
#include "agent/capture/source.h"
#include "agent/gpu/matcher_for.h"
#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/replay_rate.h"
#include "common/base/text.h"
#include "common/config/config.h"
#include "common/dataset/result_folder.h"
#include "deploy/coslam/commands.h"
#include "deploy/coslam/run/other_lenses.h"
#include "deploy/coslam/run/outcome.h"
#include "deploy/coslam/run/own_bodies.h"
#include "deploy/coslam/run/played.h"
#include "deploy/coslam/run/run.h"
#include "deploy/coslam/run/sources.h"
#include "deploy/coslam/run/starts.h"
#include "deploy/coslam/sequence_argument.h"
#include "deploy/coslam/view_flag.h"

namespace coslam {
namespace {

struct RunArguments {
  std::vector<std::string> sequence;
  std::string out = "result";
  std::vector<std::string> agents;
  CoverArguments covered;
  bool in_one_process = false, force = false;
  std::string view_port;  // empty: not shown
  RunOptions options;
};

void select_agents(Sequence& sequence, const std::vector<std::string>& names) {
  if (names.empty()) return;
  std::vector<SequenceAgent> chosen;
  for (const std::string& name : names) {
    const auto at = std::find_if(sequence.agents.begin(), sequence.agents.end(),
                                 [&](const SequenceAgent& a) { return a.name == name; });
    if (at == sequence.agents.end()) throw UsageError(no_such_agent(sequence, name));
    if (std::ranges::count(names, name) > 1) throw UsageError("--agents names " + name + " twice");
    chosen.push_back(*at);
  }
  // The known baseline is that of the sequence's own first two.
  const bool same_pair = chosen.size() >= 2 && sequence.agents.size() >= 2 &&
                         chosen[0].name == sequence.agents[0].name && chosen[1].name == sequence.agents[1].name;
  if (sequence.baseline_m && !same_pair) {
    log_warn("scale.baseline_m is left out: it is the distance of the first two agents of the sequence");
    sequence.baseline_m.reset();
  }
  std::erase_if(sequence.rigs, [&](const RigCamera& r) {
    const auto plays = [&](const std::string& name) {
      return std::ranges::any_of(chosen, [&](const SequenceAgent& a) { return a.name == name; });
    };
    return !plays(r.camera) || !plays(r.first);
  });
  sequence.agents = std::move(chosen);
}

RunConfig checked_sets(const std::vector<std::string>& sets) {
  RunConfig checked;
  for (const std::string& s : sets) config::apply_set(checked, s);
  return checked;
}

// What the sequence knows of the scale: the distance of two cameras, or the side of tags, which the agents are to look
// for. --set goes before.
void know_scale(const Sequence& sequence, std::vector<std::string>& sets) {
  if (sequence.baseline_m && sequence.agents.size() < 2) {
    log_warn("scale.baseline_m is left out: it is the distance of the first two agents, and there is one");
  }
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
  checked_sets(sets);
}

// To go through a long video takes minutes: there what its container says does.
int count_of(ImageSource& source) {
  if (const auto about = source.about_left()) return *about;
  int frames = 0;
  while (!source.live() && source.skip()) ++frames;
  return frames;
}

// Opens everything once, so that bad input is one sentence before anything starts; what else there is to say of it the
// agents say. Returns the number of frames of the longest.
int check_inputs(const Sequence& sequence) {
  const LogPause agents_say_it;
  int most = 0;
  for (const SequenceAgent& a : sequence.agents) {
    const auto source = open_camera(a.source, a.calibration, {a.start_s, a.duration_s, sequence.rate_hz}).images;
    most = std::max(most, count_of(*source));
  }
  return most;
}

// Its result would take the place of what is to be played.
void refuse_own_folder(const RunOptions& options) {
  std::vector<std::filesystem::path> played{options.sequence.file};
  for (const SequenceAgent& a : options.sequence.agents) {
    played.insert(played.end(), {a.calibration, a.truth.value_or(""), a.mask.value_or("")});
    if (!is_live_source(a.source)) played.emplace_back(a.source);
  }
  for (const std::filesystem::path& file : played) {
    if (file.empty() || !ResultFolder(options.out).would_remove(file)) continue;
    throw UserError(file.string() + " is to be played, and lies where the result in " + options.out.string() +
                    " would replace it: name another folder with --out");
  }
}

// `--view 8766`: the flag stands alone, and the port became a source.
void refuse_loose_port(const RunArguments& arguments) {
  if (arguments.view_port.empty()) return;
  for (const std::string& text : arguments.sequence) {
    if (parse_integer(text) && !std::filesystem::exists(text)) {
      throw UsageError("there is no source " + text + "; a port of --view takes an equals sign: --view=" + text);
    }
  }
}

int run(RunArguments arguments) {
  RunOptions& options = arguments.options;
  refuse_loose_port(arguments);
  parse_replay_rate(options.rate);                        // a wrong one is said before anything starts
  matcher_for(checked_sets(options.sets).agent.tracker);  // a device that is not there
  if (std::filesystem::exists(options.record)) {
    throw UserError(options.record.string() + " exists already: name another file for the recording");
  }
  options.sequence = sequence_argument(arguments.sequence);
  select_agents(options.sequence, arguments.agents);
  if (!arguments.view_port.empty()) options.sets.push_back("server.view.port=" + arguments.view_port);
  if (const std::string shared = shared_source(options.sequence.agents); !shared.empty()) log_warn(shared);
  know_scale(options.sequence, options.sets);
  cover_lenses(options.sequence, arguments.covered);
  options.out = arguments.out;
  refuse_own_folder(options);
  options.frame_sets = check_inputs(options.sequence);
  if (arguments.in_one_process && options.rate != "max") throw UsageError("--inline runs at --rate max only");
  make_result_folder(options.out, arguments.force);
  Starts starts(&options.sequence);
  OwnBodies own_bodies(&options.sequence);
  const auto play = [&] { return arguments.in_one_process ? run_inline(options) : run_processes(options); };
  RunEnd end = play();
  const bool whole = end.exit_code == 0 && !end.interrupted;
  const bool other_times = whole && starts.improve(options.out), bodies = whole && own_bodies.improve(options.out);
  const bool lenses = whole && leave_other_lenses(&options.sequence, options.out);
  if ((other_times || bodies || lenses) && options.map.empty() && options.record.empty()) {
    if (other_times) log_info("run once more, with each source at the time that was found");
    if (bodies) log_info("run once more, without what moves with the cameras");
    if (lenses) log_info("run once more, with lenses that are found from the images");
    make_result_folder(options.out, true);
    own_bodies.write(options.out);
    end = play();
  } else if (other_times || bodies || lenses) {
    log_warn("this run is not repeated with what it found: what --map or --record keeps is of one run");
  }
  starts.say();
  starts.write(options.out);
  note_played(options.sequence, options.sets, ResultFolder(options.out));
  const bool mapped = print_summary(options.out);
  return end.exit_code == 0 && !mapped && !end.interrupted ? 1 : end.exit_code;
}

}  // namespace

void add_run_command(CLI::App& app, Command& chosen) {
  auto arguments = std::make_shared<RunArguments>();
  RunOptions& options = arguments->options;
  CLI::App* command = app.add_subcommand("run", "Build one map from all cameras of a sequence");
  command
      ->add_option("SEQUENCE", arguments->sequence,
                   "a YAML file, a folder with sequence.yaml, sim:NAME, or one source a camera: a video, a folder of "
                   "images, bag:PATH#TOPIC, ros2:/TOPIC, v4l2:N, rtsp://...")
      ->required();
  command->add_option("--out", arguments->out, "RESULT folder")->type_name("DIR")->capture_default_str();
  command->add_flag("--force", arguments->force, "replace the run that the folder holds");
  command->add_option("--agents", arguments->agents, "only these, in this order: a,b")
      ->type_name("NAMES")
      ->delimiter(',');
  add_cover_option(*command, arguments->covered);
  command->add_option("--rate", options.rate, "speed of replay: a factor of real time, or max (drops nothing)")
      ->type_name("R")
      ->capture_default_str();
  command->add_flag("--inline", arguments->in_one_process, "one process, same code");
  add_view_flag(*command, arguments->view_port);
  command->add_option("--map", options.map, "file to keep the map in; if there is one, it goes on")->type_name("FILE");
  command->add_option("--record", options.record, "new file: what the map server hears, for coslam replay")
      ->type_name("FILE");
  command->add_option("--domain", options.domain, "DDS domain, 0 to 232; default: one that depends on the process")
      ->type_name("N")
      ->check(CLI::Range(0, 232));
  command->add_option("--set", options.sets, "override a key of the configuration: agent.KEY=VALUE or server.KEY=VALUE")
      ->type_name("KEY=VALUE");
  command->callback([arguments, &chosen] { chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace coslam
