// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <csignal>
#include <utility>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/printed.h"
#include "common/config/program.h"
#include "common/wire/addresses.h"
#include "common/wire/codec.h"
#include "common/wire/participant.h"
#include "common/wire/peer_names.h"
#include "common/wire/run_id.h"
#include "server/app/greeting.h"
#include "server/app/recorded_config.h"
#include "server/app/server_loop.h"
#include "server/app/server_options.h"
#include "server/app/stop_signals.h"
#include "server/estimator/pipeline/stage_table.h"
#include "server/fleet/link/dds_server_link.h"
#include "server/fleet/record/recording_link.h"
#include "server/show/live_view.h"
#include "server/show/log_sink.h"
#include "server/show/mcap_file.h"
#include "server/show/public_relay.h"
#include "server/show/snapshot_observer.h"

namespace coslam {
namespace {

// What the server does: in the log, once a minute while frames come, or each second on standard output for the program
// that started it, which also waits for the words "ready" (no other server is in the domain) and "started" (all agents
// are here).
class Announcer {
 public:
  Announcer(bool for_programs, Greeting greeting) : for_programs_(for_programs), greeting_(std::move(greeting)) {}

  void show(const ServerLink& link, const ServerLoop& loop) {
    if (for_programs_ && !ready_ && link.at_work()) ready_ = say("ready");
    if (for_programs_ && !started_ && loop.started()) started_ = say("started");
    if (!for_programs_ && !ready_ && link.at_work()) ready_ = greet();
    const auto now = std::chrono::steady_clock::now();
    const MapServer& s = loop.map_server();
    const auto period = std::chrono::seconds(for_programs_ || shown_sets_ == 0 ? 1 : 60);
    if (now - last_ < period || s.counts().frame_sets == shown_sets_) return;
    last_ = now;
    shown_sets_ = s.counts().frame_sets;
    const std::string sets = std::to_string(shown_sets_);
    if (for_programs_) {
      say("progress " + sets);
    } else {
      log_info("frame set " + sets + ", " + std::to_string(s.map().points().size()) + " points, " +
               std::to_string(s.map().key_frames().size()) + " key frames");
    }
  }

  // addresses: of this machine, where it listens on all of them; not every network knows its name.
  void show(const LiveView& view, const std::vector<std::string>& addresses) const {
    const std::string line = "view: " + view.url();
    if (for_programs_) {
      say(line);
    } else {
      log_info(line);
      for (const std::string& address : addresses) log_info("view: " + view.url(address));
    }
  }

  // Each percent for the program that started it, each tenth in the log.
  static void show_adjusting(bool for_programs, int percent) {
    static int shown = 0;
    const int step = for_programs ? 1 : 10;
    if (percent / step == std::exchange(shown, percent) / step) return;
    if (for_programs) {
      say("adjusting " + std::to_string(percent));
    } else {
      log_info("adjusting: " + std::to_string(percent) + " %");
    }
  }

 private:
  static bool say(const std::string& line) {
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
    return true;
  }

  bool greet() const {
    log_info("map server in " + greeting_.place);
    log_info("an agent joins with: " + greeting_.agent);
    return true;
  }

  bool for_programs_, ready_ = false, started_ = false;
  const Greeting greeting_;
  int shown_sets_ = 0;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

struct ServeOptions {
  ServerOptions keys;
  std::string runs, result, map, record, mcap;  // empty: none
  bool progress = false;
};

// What came of each agent, at the end.
void say_paths(const nlohmann::ordered_json& report) {
  const auto agents = report.find("agents");
  if (agents == report.end()) return;
  for (const auto& [name, agent] : agents->items()) {
    const auto path = agent.find("path");
    if (path == agent.end() || !path->is_object()) continue;
    const std::string why = path->value("why", "");
    log_info(name + ": " + printed("%.1f", agent.value("tracked_percent", 0.0)) +
             " % of its images are tracked; its path is " + path->value("quality", "") +
             (why.empty() ? "" : ", as " + why));
  }
}

void serve(const ServeOptions& options) {
  const ServerOptions& keys = options.keys;
  const RunId run = draw_run_id();
  const auto wire = open_server_link(keys.wire, run);
  std::optional<RecordingLink> recording;
  if (!options.record.empty()) {
    recording.emplace(*wire, options.record, recording_head(run, {keys.agents, keys.server}));
  }
  ServerLink& link = recording ? *recording : *wire;
  ServerLoop loop(link, run,
                  {.server = keys.server,
                   .expected_agents = keys.agents,
                   .result = {options.result, options.runs},
                   .map = options.map,
                   .adjusting = [&](int percent) { Announcer::show_adjusting(options.progress, percent); }});
  Announcer announcer(options.progress, greeting(keys.wire, addresses_used(keys.wire),
                                                 options.runs.empty() ? options.result : options.runs));
  PublicRelay relay(link);
  LogSink log;
  std::vector<PublicSink*> sinks{&relay, &log};
  std::optional<McapFile> mcap;
  if (!options.mcap.empty()) sinks.push_back(&mcap.emplace(options.mcap));
  std::optional<LiveView> view;
  std::optional<SnapshotObserver> teller;
  if (keys.view.on()) {
    const bool on_all = keys.view.address == "0.0.0.0" || keys.view.address == "::";
    view.emplace(keys.view, loop.map_server(), sinks,
                 [&link](const std::string& agent) { return link.thumbnail(agent); });
    announcer.show(*view, on_all ? addresses_used(keys.wire) : std::vector<std::string>());
    loop.observe(view->observer());
  } else {
    loop.observe(teller.emplace(loop.map_server(), sinks));
  }
  while (!stop_requested() && loop.poll(std::chrono::milliseconds(20))) announcer.show(link, loop);
  announcer.show(link, loop);
  if (recording) recording->end();
  log_info(stop_requested() ? "stopped" : "all agents have ended");
  loop.finish(config::dump_json(without_secrets(keys)), stop_is_urgent());
  if (!options.progress) say_paths(loop.report());
  // A program that started this one reads the report.
  if (!options.progress && !stop_is_urgent() && !loop.problem().empty()) throw UserError(loop.problem());
}

// Nobody comes under a name that is none, or comes twice.
void require_names(const std::vector<std::string>& agents) {
  for (const std::string& name : agents) {
    if (!valid_agent_name(name)) {
      throw UserError("agents: '" + name + "' is no name for an agent: up to 32 letters, digits, '_', '-' and '.'");
    }
    if (std::ranges::count(agents, name) > 1) throw UserError("agents: '" + name + "' is named twice");
  }
}

// Looks at what only makes sense together.
void require_sense(ServerOptions& keys) {
  require_names(keys.agents);
  if (keys.server.map.of<ScaleConfig>().baseline_m > 0 && keys.agents.empty()) {
    throw UserError(
        "server.baseline_m is the distance of the first two of `agents`: name them all, as in --set agents=a,b,c");
  }
}

int print_stages() {
  std::printf("%s", markdown_of(stage_access<MapPipeline>()).c_str());
  return 0;
}

int main_of(int argc, char** argv) {
  CLI::App app("Map server: builds one map from the tracks of all agents; see docs/configuration.md");
  ServeOptions options;
  CommonArguments common;
  std::optional<int> domain, view_port;
  bool loopback = false, stages = false;
  common.add_to(app, "server.yaml", "server.theta=2.5");
  app.add_option("--domain", domain, "DDS domain, 0 to 232")->type_name("N")->check(CLI::Range(0, 232));
  auto* out =
      app.add_option("--out", options.runs, "where the RESULT of each run gets a folder; DIR/latest is the newest");
  out->type_name("DIR");
  app.add_option("--result", options.result, "for programs: the RESULT folder itself")->type_name("DIR")->excludes(out);
  app.add_option("--map", options.map, "file to keep the map in; if there is one, it goes on")->type_name("FILE");
  app.add_option("--record", options.record, "new file: what the agents send, for coslam replay")->type_name("FILE");
  app.add_option("--mcap", options.mcap, "new file: the run for Foxglove and other viewers, while it happens")
      ->type_name("FILE");
  app.add_option("--view", view_port, "show it on the web, on this port of this host; 0: a free one")
      ->type_name("PORT")
      ->check(CLI::Range(0, 65535));
  app.add_flag("--loopback", loopback, "talk on this machine only");
  app.add_flag("--report-progress", options.progress,
               "for programs: 'view: URL', 'ready', 'started' and 'progress DONE' on standard output");
  app.add_flag("--stages", stages, "print what each stage of the pipeline reads and writes, and end");
  if (const auto code = parse_arguments(app, argc, argv)) return *code;
  if (stages) return print_stages();
  init_log("server", common.log_format);
  ServerOptions& o = options.keys;
  if (loopback) o.wire = loopback_config(0);
  common.apply_to(o);
  if (domain) o.wire.domain = *domain;
  if (view_port) o.view.port = *view_port;
  require_sense(o);
  if (common.print) {
    print_config("coslam-server", o);
  } else {
    await_names(&o.wire.peers, while_starting(stop_requested));
    serve(options);
  }
  return 0;
}

}  // namespace
}  // namespace coslam

int main(int argc, char** argv) {
  coslam::catch_stop_signals();
  std::signal(SIGPIPE, SIG_IGN);  // a result is written even when nobody reads the progress any more
  return coslam::run_program("coslam-server", [&] { return coslam::main_of(argc, argv); });
}
