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

// The agents of a server: who may take part, who is here, and what became of each one's images. Pure.
// Thread-compatible.
class Roster {
 public:
  // Agents of different names, in the life of a server: each keeps a camera in the map and a path in the result when it
  // has left.
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
    std::uint64_t missed = 0;  // images of this run that lie before what was played when it joined
    TimeNs past_ns = 0;        // time that was played until then
    bool said_images = false;  // its account was given for the last time
  };

  // expected: names of all that take part, in this order; empty: whoever comes.
  explicit Roster(std::vector<std::string> expected) : expected_(std::move(expected)) {}

  const std::vector<std::string>& expected() const { return expected_; }
  const std::map<std::string, Agent>& agents() const { return agents_; }
  bool knows(const std::string& name) const { return agents_.contains(name); }

  // Why an agent cannot take part; empty: it can.
  std::optional<std::string> why_not(const Hello& hello) const;
  // Before the start: an agent that was expected waits for the others, or has gone again.
  void wait(const Hello& hello) { waiting_[hello.agent] = hello; }
  void stop_waiting(const std::string& name) { waiting_.erase(name); }
  // Those that were expected, in that order, once all are here; empty: not yet.
  std::vector<Hello> take_complete();

  // An agent takes part from now on, as that camera. seen_before: it sent images of this run to a server before this
  // one.
  void admit(const Hello& hello, CameraId camera, bool seen_before);
  // Null: no such run takes part now.
  Agent* find(const std::string& name, RunId run);
  Agent& at(const std::string& name) { return agents_.at(name); }
  bool all_ended() const;
  // Names of all, those that have ended last.
  std::vector<std::string> names() const;

  // Notes an image that lies before what was played when its agent joined. late: in lock-step what such an agent sends
  // is late; in real time it begins with what is due then. past_ns: frames that are older are late.
  static void note_missed(const TrackFrame& frame, bool late, std::optional<TimeNs> past_ns, Agent* agent);
  // Notes which frames of a set have poses in the map.
  void count_used(const FrameSet& set, const Map& map);

  std::vector<ReportedAgent> reported(const MapServer& server) const;
  // Final account of an agent's images; maps: of the server now.
  static ImageAccount account_of(const Agent& agent, const MapServer& server, const std::vector<MapFrames>& maps);
  // What the user should know of an agent's images; empty: nothing.
  static std::string problem_of(const std::string& name, const Agent& agent, const ImageAccount& images);

 private:
  const std::vector<std::string> expected_;
  std::map<std::string, Hello> waiting_;  // before the start
  std::map<std::string, Agent> agents_;
};

}  // namespace coslam
