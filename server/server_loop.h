// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/link/server_link.h"
#include "server/observe/result_store.h"
#include "server/refiner.h"
#include "server/server_config.h"

namespace coslam {

struct ServerLoopConfig {
  ServerConfig server;
  std::vector<std::string>
      expected_agents;        // wait for all of these, number cameras in this order, end when they have; empty: run on
  std::filesystem::path out;  // RESULT folder; empty: none
  bool refine_in_thread = true;  // false: in the caller's thread, where its result is due
};

// The map thread of the server: events from the link in, frame sets through the stages, patches out. Thread-compatible.
class ServerLoop {
 public:
  // Different names, in the life of a server: each keeps a camera in the map and a path in the result when it has left.
  static constexpr std::size_t kMostAgents = 1000;

  ServerLoop(ServerLink& link, RunId run, const ServerLoopConfig& config);
  ~ServerLoop() = default;
  ServerLoop(const ServerLoop&) = delete;
  ServerLoop& operator=(const ServerLoop&) = delete;

  // Handles one event (waiting for it up to `timeout`) and every frame set that became complete. False once it is done:
  // all expected agents have ended and their frames are used.
  bool poll(std::chrono::milliseconds timeout);
  // Adjusts the whole run, writes the result, tells the agents that the server stops. configuration: the one in
  // effect, for the report.
  void finish(const nlohmann::ordered_json& configuration);

  bool started() const { return started_; }
  const MapServer& map_server() const { return server_; }
  const nlohmann::ordered_json& report() const { return report_; }

 private:
  struct Agent {
    CameraId camera;
    RunId run;
    bool ended = false;
    AgentStatus last_status;
  };

  void handle(const ServerEvent& event);
  void on_hello(const Hello& hello);
  void on_frame(const JoinedFrame& joined);
  void on_status(const AgentStatus& status);
  void on_silent(const std::string& name, RunId run);
  void on_gone(const std::string& name, RunId run);
  void admit(const Hello& hello);
  void start_if_complete();
  void run_set(const FrameSet& set);
  Agent* find(const std::string& name, RunId run);  // null: no such run now
  void end(Agent& agent);
  void give_refined(std::optional<RefineSolution> solution);
  void send_status();

  ServerLink& link_;
  ServerLoopConfig config_;
  MapServer server_;
  FrameSetSync sync_;
  std::optional<ResultStore> store_;
  Refiner refiner_;
  std::map<std::string, Hello> waiting_;  // before the start
  std::map<std::string, Agent> agents_;
  bool started_ = false, stopping_ = false, lockstep_ = false;
  std::chrono::steady_clock::time_point last_status_{};
  TimeNs start_utc_ns_ = 0;
  nlohmann::ordered_json report_;
};

}  // namespace coslam
