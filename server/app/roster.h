// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "server/app/why_no_pose.h"
#include "server/fleet/sync/image_tally.h"
#include "server/keep/report.h"

namespace coslam {

// Stamps below this count from the beginning of a recording.
inline constexpr TimeNs kFirstDate_ns = 1'000'000'000'000'000'000;

// Agents of a server: who may take part, who is here, and what became of each one's images. Pure. Thread-compatible.
class Roster {
 public:
  // Most agents of different names in the life of a server: each keeps a camera in the map and a path in the result
  // when it has left.
  static constexpr std::size_t kMostAgents = 1000;

  struct Agent {
    CameraId camera;
    RunId run;
    Pacing pacing = Pacing::kLive;
    bool ended = false;
    AgentStatus last_status;
    ImageTally images;
    SeenWithoutPose seen;
    bool begun = false;        // a frame of this run was used
    std::uint64_t missed = 0;  // images of this run from before what was played when it joined
    TimeNs past_ns = 0;        // time that was played until it joined
    bool said_images = false;  // final account was given
  };

  // expected: names of all agents that take part, in this order; empty: any agent may.
  explicit Roster(std::vector<std::string> expected) : expected_(std::move(expected)) {}

  const std::vector<std::string>& expected() const { return expected_; }
  const std::map<std::string, Agent>& agents() const { return agents_; }
  bool knows(const std::string& name) const { return agents_.contains(name); }

  // Reason why an agent cannot take part; empty: it can.
  std::optional<std::string> why_not(const Hello& hello) const;
  // Notes, before the start, that an expected agent waits for the others, or has left again.
  void wait(const Hello& hello) { waiting_[hello.agent] = hello; }
  void stop_waiting(const std::string& name) { waiting_.erase(name); }
  // Returns the expected agents, in their order, once all are here; empty: not yet.
  std::vector<Hello> take_complete();

  // Admits an agent as that camera. seen_before: it sent images of this run to an earlier server.
  void admit(const Hello& hello, CameraId camera, bool seen_before);
  // Finds an agent that takes part; null: no such run does now.
  Agent* find(const std::string& name, RunId run);
  Agent& at(const std::string& name) { return agents_.at(name); }
  bool all_ended() const;
  // Names of all agents, those that have ended last.
  std::vector<std::string> names() const;

  // Notes an image from before what was played when its agent joined. late: in lock-step the images of such an agent
  // are late; in real time it begins with the frames that are due then. past_ns: older frames are late.
  static void note_missed(const TrackFrame& frame, bool late, std::optional<TimeNs> past_ns, Agent* agent);
  // Notes which frames of a set have poses in the map.
  void count_used(const FrameSet& set, const Map& map);

  std::vector<ReportedAgent> reported(const MapServer& server) const;
  // Final account of an agent's images; maps: of the server now.
  static ImageAccount account_of(const Agent& agent, const MapServer& server, const std::vector<MapFrames>& maps);
  // Warning about an agent's images for the user; empty: none.
  static std::string problem_of(const std::string& name, const Agent& agent, const ImageAccount& images);

 private:
  const std::vector<std::string> expected_;
  std::map<std::string, Hello> waiting_;  // agents that wait for the start
  std::map<std::string, Agent> agents_;
};

}  // namespace coslam
