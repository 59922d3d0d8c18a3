// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/log.h"
#include "common/flow/clock.h"
#include "common/flow/worker_pool.h"
#include "server/app/play_order.h"
#include "server/app/server_config.h"
#include "server/app/server_observer.h"
#include "server/app/why_no_pose.h"
#include "server/estimator/refiner.h"
#include "server/fleet/link/server_link.h"
#include "server/fleet/sync/backlog.h"
#include "server/fleet/sync/frame_set_sync.h"
#include "server/fleet/sync/image_tally.h"
#include "server/fleet/sync/stamp_watch.h"
#include "server/keep/map_keeper.h"
#include "server/keep/observe/result_store.h"
#include "server/keep/report.h"
#include "server/show/publish/snapshot.h"

namespace coslam {

// What time it is, in ns. Neither may be called from another thread than the loop's.
struct ServerClock {
  std::function<TimeNs()> monotonic_ns = monotonic_now_ns;
  std::function<TimeNs()> utc_ns = utc_now_ns;
};

struct ServerLoopConfig {
  ServerConfig server;
  std::vector<std::string>
      expected_agents;         // wait for all of these, number cameras in this order, end when they have; empty: run on
  std::filesystem::path out;   // RESULT folder; empty: none
  std::filesystem::path runs;  // or where to make one for this run, when its first agent has joined
  std::filesystem::path map;   // file that the map is kept in; empty: none
  bool refine_in_thread = true;  // false: in the caller's thread, where its result is due
  ServerClock clock;             // another one for a recording
  TellProgress adjusting;        // how far the adjustment at the end is; may be empty
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
  // Writes the result, tells the agents that the server stops, adjusts the whole run and writes the result again. While
  // it adjusts EndsAtOnce holds (stop_signals.h). configuration: the one in effect, for the report. Throws UserError
  // when something could not be written.
  // short_end: without the adjustment, for whoever has no time.
  void finish(const nlohmann::ordered_json& configuration, bool short_end = false);

  // Shows it what happens from now on; one at most.
  void observe(ServerObserver* observer);

  bool started() const { return started_; }
  const MapServer& map_server() const { return server_; }
  const nlohmann::ordered_json& report() const { return report_; }
  // All agents have ended and none has a pose: a sentence; empty: that is not so.
  std::string problem() const;
  std::vector<ReportedAgent> agents() const;
  LoopFacts facts() const;

 private:
  struct Agent {
    CameraId camera;
    RunId run;
    Pacing pacing = Pacing::kLive;
    bool ended = false;
    AgentStatus last_status;
    ImageTally images;
    SeenWithoutPose seen;
    bool begun = false;        // a frame of this run was used
    std::uint64_t missed = 0;  // images of this run that lie before what was played when it joined
    TimeNs past_ns = 0;        // which is until then
    bool said_images = false;  // for the last time
  };

  void handle(const ServerEvent& event);
  void on_hello(const Hello& hello);
  void on_frame(const JoinedFrame& joined);
  void on_status(const AgentStatus& status);
  static void say_images(const AgentStatus& status);
  void on_silent(const std::string& name, RunId run);
  void on_gone(const std::string& name, RunId run);
  std::optional<std::string> why_not(const Hello& hello) const;
  void admit(const Hello& hello);
  void start_if_complete();
  void take_events(std::chrono::milliseconds timeout);
  std::optional<FrameSet> next_set();
  void run_set(const FrameSet& set);
  void count_used(const FrameSet& set);
  ImageAccount account_of(const Agent& agent, const std::vector<MapFrames>& maps) const;
  void note_missed(const TrackFrame& frame, bool late, Agent& agent) const;
  void say_images_of(const std::string& name, Agent& agent);
  void order_play();
  std::string problem_of(const std::string& name, const Agent& agent, const ImageAccount& images) const;
  ImageTally& images_of(CameraId camera) { return agents_.at(server_.map().camera(camera).name).images; }
  Agent* find(const std::string& name, RunId run);  // null: no such run now
  void end(Agent& agent);
  void take_known_past();
  void give_refined(std::optional<RefineSolution> solution);
  void send_status();
  void open_result();
  void report_now(bool adjusted, const nlohmann::ordered_json& configuration);
  bool write_first(bool adjusts);

  ServerLink& link_;
  ServerLoopConfig config_;
  WorkerPool workers_;
  MapServer server_;
  FrameSetSync sync_;
  StampWatch stamps_;
  Backlog backlog_;
  std::uint32_t left_out_ = 0;  // sets
  LogLimiter left_out_log_;
  std::optional<ResultStore> store_;
  std::filesystem::path result_;  // its folder
  std::optional<MapKeeper> keeper_;
  std::vector<CameraId> known_past_;  // agents that joined since what the map file has of them was asked for
  ServerObserver* observer_ = nullptr;
  Refiner refiner_;
  std::map<std::string, Hello> waiting_;  // before the start
  std::map<std::string, Agent> agents_;
  bool runs_made_ = false;
  bool started_ = false, stopping_ = false, lockstep_ = false;
  TimeNs last_status_ns_ = 0;
  PlayOrder play_order_;
  TimeNs start_utc_ns_ = 0;
  nlohmann::ordered_json report_;
};

}  // namespace coslam
