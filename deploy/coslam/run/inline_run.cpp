// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <opencv2/core/utility.hpp>

#include "agent/agent_loop.h"
#include "agent/capture/camera_of.h"
#include "common/base/log.h"
#include "common/config/config.h"
#include "deploy/coslam/console.h"
#include "deploy/coslam/run/inline_link.h"
#include "deploy/coslam/run/run.h"
#include "deploy/coslam/run/told.h"
#include "server/app/recorded_config.h"
#include "server/app/server_loop.h"
#include "server/app/server_options.h"
#include "server/app/stop_signals.h"
#include "server/fleet/record/recording_link.h"

namespace coslam {
namespace {

struct InlineAgent {
  std::unique_ptr<AgentLink> link;
  std::unique_ptr<AgentLoop> loop;
  RunId run;
  bool running = true;
};

InlineAgent connect_agent(InlineLink& link, const RunOptions& options, const SequenceAgent& agent, RunId run,
                          AgentConfig config) {
  Hello hello;
  hello.agent = agent.name;
  hello.agent_run = run;
  hello.pacing = Pacing::kLockstep;
  hello.rate_hz = options.sequence.rate_hz;
  SourceOptions play{agent.start_s, agent.duration_s, options.sequence.rate_hz};
  play.covered = agent.covered;
  play.rate_is_given = options.sequence.rate_is_given;
  auto [found, images] = open_camera(agent.source, agent.calibration, play);
  hello.camera = found.camera;
  if (!found.guess.empty()) log_warn("agent " + agent.name + ": " + found.guess);
  InlineAgent out;
  out.run = run;
  out.link = link.connect(hello);
  if (agent.mask) config.tracker.mask = agent.mask->string();
  out.loop = std::make_unique<AgentLoop>(*out.link, direct_feed(std::move(images)), hello, config);
  out.loop->plays_from(agent.start_s);
  out.loop->log_state(AgentLoop::LogsAs::kOneOfSeveral);
  return out;
}

// Another than any that the map's cameras had: those are over.
RunId first_run(const Map& map) {
  RunId last(1);  // the server's
  for (const MapCamera& c : map.cameras()) last = std::max(last, c.run);
  return RunId(last.value + 1);
}

}  // namespace

RunEnd run_inline(const RunOptions& options) {
  catch_stop_signals();
  cv::setNumThreads(1);
  RunConfig config;
  for (const std::string& s : options.sets) config::apply_set(config, s);

  const RunId server_run(1);
  InlineLink link(server_run);
  ProgressOfRun progress;
  ServerLoopConfig server_config{.server = config.server,
                                 .result = {.folder = options.out, .runs = {}},
                                 .map = options.map,
                                 .refine_in_thread = false,
                                 .adjusting = [&](int percent) { progress.adjusting(percent); }};
  for (const SequenceAgent& a : options.sequence.agents) server_config.expected_agents.push_back(a.name);
  std::optional<RecordingLink> recording;
  if (!options.record.empty()) {
    const RecordedConfig recorded{server_config.expected_agents, config.server};
    recording.emplace(link.server(), options.record, recording_head(server_run, recorded));
  }
  ServerLoop server(recording ? *recording : link.server(), server_run, server_config);
  const RunTold observers(config.view, server);
  std::vector<InlineAgent> agents;
  RunId run = first_run(server.map_server().map());
  for (const SequenceAgent& a : options.sequence.agents) {
    agents.push_back(connect_agent(link, options, a, run, config.agent));
    ++run.value;
  }

  const std::chrono::milliseconds no_wait(0);
  while (server.poll(no_wait) && !stop_requested()) {
    for (InlineAgent& a : agents) {
      if (!a.running || link.owes_answer(a.run) || a.loop->step(stop_requested())) continue;
      a.loop->finish(stop_requested());
      a.running = false;
    }
    progress.mapping(std::min(server.map_server().counts().frame_sets, options.frame_sets), options.frame_sets);
  }
  if (recording) recording->end();
  server.finish(config::dump_json(without_secrets(config)));
  return {0, stop_requested()};
}

}  // namespace coslam
