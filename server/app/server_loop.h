// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/log.h"
#include "common/flow/clock.h"
#include "common/flow/worker_pool.h"
#include "server/app/play_order.h"
#include "server/app/roster.h"
#include "server/app/server_config.h"
#include "server/estimator/refiner.h"
#include "server/fleet/link/server_link.h"
#include "server/fleet/sync/set_clock.h"
#include "server/keep/map_keeper.h"
#include "server/keep/result_recorder.h"
#include "server/keep/set_observers.h"

namespace coslam {

// Clocks of the server, in ns. Neither may be called from another thread than the loop's.
struct ServerClock {
  std::function<TimeNs()> monotonic_ns = monotonic_now_ns;
  std::function<TimeNs()> utc_ns = utc_now_ns;
};

struct ServerLoopConfig {
  ServerConfig server;
  std::vector<std::string> expected_agents;  // agents to wait for, in the order of their cameras; the server ends when
                                             // they have; empty: run on
  ResultPlace result;
  std::filesystem::path map;     // map file; empty: none
  bool refine_in_thread = true;  // false: in the caller's thread, where the result is due
  ServerClock clock;             // replaced for a recording
  TellProgress adjusting;        // receives the progress of the adjustment at the end; may be empty
};

// Map thread of the server: takes events from the link, runs frame sets through the stages, sends patches.
// Thread-compatible.
class ServerLoop {
 public:
  ServerLoop(ServerLink& link, RunId run, const ServerLoopConfig& config);
  ~ServerLoop() = default;
  ServerLoop(const ServerLoop&) = delete;
  ServerLoop& operator=(const ServerLoop&) = delete;

  // Handles one event (waiting for it up to `timeout`) and every frame set that became complete. False once it is done:
  // all expected agents have ended and their frames are used.
  bool poll(std::chrono::milliseconds timeout);
  // Writes the result, tells the agents that the server stops, adjusts the whole run and writes the result again. While
  // it adjusts, EndsAtOnce is active (stop_signals.h). configuration: the one in effect, for the report. short_end:
  // without the adjustment, when there is no time. Throws UserError when something could not be written.
  void finish(const nlohmann::ordered_json& configuration, bool short_end = false);

  // Reports to the observer from now on; it outlives the loop's last call.
  void observe(SetObserver& observer);

  bool started() const { return started_; }
  const MapServer& map_server() const { return server_; }
  const nlohmann::ordered_json& report() const { return report_; }
  // Sentence when all agents have ended and none has a pose; else empty.
  std::string problem() const;
  std::vector<ReportedAgent> agents() const { return roster_.reported(server_); }
  LoopFacts facts() const;

 private:
  void handle(const ServerEvent& event);
  void on_hello(const Hello& hello);
  void on_frame(const JoinedFrame& joined);
  void on_status(const AgentStatus& status);
  void on_silent(const std::string& name, RunId run);
  void on_gone(const std::string& name, RunId run);
  void admit(const Hello& hello);
  void start_if_complete();
  void order_start();
  void take_events(std::chrono::milliseconds timeout);
  std::optional<FrameSet> next_set();
  void run_set(const FrameSet& set);
  void say_images_of(const std::string& name, Roster::Agent& agent);
  void end(Roster::Agent& agent);
  void give_refined(std::optional<RefineSolution> solution);
  void send_status();
  void report_now(bool adjusted, const nlohmann::ordered_json& configuration);
  bool write_first(bool adjusts);
  ServerView view() const;

  ServerLink& link_;
  ServerLoopConfig config_;
  WorkerPool workers_;
  MapServer server_;
  SetClock sets_;
  Roster roster_;
  LogLimiter left_out_log_;
  std::optional<MapKeeper> keeper_;
  std::optional<ResultRecorder> recorder_;
  SetObservers observers_;
  Refiner refiner_;
  bool started_ = false, stopping_ = false;
  TimeNs last_status_ns_ = 0;
  PlayOrder play_order_;
  TimeNs start_utc_ns_ = 0;
  nlohmann::ordered_json report_;
};

}  // namespace coslam
