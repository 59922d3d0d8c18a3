// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>

#include "server/estimator/map_server.h"
#include "server/show/publish/copies.h"
#include "server/show/publish/event_feed.h"
#include "server/show/publish/main_map.h"
#include "server/show/publish/odom_frames.h"
#include "server/show/publish/snapshot.h"

namespace coslam {

// Looks at the map after each frame set and copies what the public is to be told: at a bounded pace, and at bounded
// cost each time, since the map's thread does nothing else meanwhile. Pure: time is an argument.
class MapWatch {
 public:
  using AskLoop = std::function<LoopFacts()>;

  explicit MapWatch(const MapServer& server);

  // Snapshot after a frame set. wanted: parts that somebody wants; now_ns: a clock that only goes on.
  Snapshot after_set(const FrameSet& set, const MapServer& server, PartSet wanted, TimeNs now_ns, const AskLoop& loop);
  // Snapshot while no frame set comes.
  Snapshot in_between(const MapServer& server, PartSet wanted, TimeNs now_ns, const AskLoop& loop);
  // The last word: all that is wanted, whatever it costs.
  Snapshot at_the_end(const MapServer& server, PartSet wanted, TimeNs now_ns, const AskLoop& loop);

 private:
  class Pace {
   public:
    // Whether the period has passed; a little earlier rather than late, as frame sets come when they do.
    bool due(TimeNs now_ns, double period_s) {
      if (last_ns_ && to_seconds(now_ns - *last_ns_) < 0.8 * period_s) return false;
      last_ns_ = now_ns;
      return true;
    }
    void forget() { last_ns_.reset(); }

   private:
    std::optional<TimeNs> last_ns_;
  };
  // Frames of one run of an agent.
  struct Frames {
    RunId run;
    FrameId first, newest;
    std::uint32_t used = 0;
  };

  void count_frames(const FrameSet& set);
  void slow_parts(const MapServer& server, PartSet wanted, TimeNs now_ns, const AskLoop& loop, Snapshot* out);
  std::shared_ptr<const PublicCloud> some_cloud(const MapServer& server, TimeNs now_ns);
  PublicState state(const MapServer& server, TimeNs now_ns, LoopFacts loop) const;
  PublicAgent agent(const MapServer& server, const AgentFacts& facts) const;
  template <class T>
  std::shared_ptr<const T> dated(const Map& map, T part) const;

  MainMap main_;
  EventFeed happenings_;
  OdomFrames odom_;
  std::map<CameraId, Frames> frames_;
  CloudCopy cloud_;
  std::optional<SetId> cloud_of_;  // the newest set when the last cloud was finished
  std::size_t cloud_bytes_ = 0;
  Pace poses_pace_, moving_pace_, tracks_pace_, paths_pace_, cloud_pace_, state_pace_;
};

}  // namespace coslam
