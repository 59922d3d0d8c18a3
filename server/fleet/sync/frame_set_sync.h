// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "server/estimator/map/map.h"

namespace coslam {

struct SyncConfig {
  double tolerance_frames = 0.55;  // share of the frame period: frames this close belong to one instant
  double deadline_s = 0.4;         // live: how long the others wait for the last
  int queue_frames = 90;           // waiting per agent at most; the oldest goes first
};

template <class V>
void describe(V& v, SyncConfig& c) {
  v.field("tolerance_frames", c.tolerance_frames, {0, 1}, "frames this close (of the period) belong to one instant");
  v.field("deadline_s", c.deadline_s, {0, 10}, "live: how long a frame set waits for the last agent");
  v.field("queue_frames", c.queue_frames, {1, 10000}, "waiting per agent at most");
}

// Gathers the frames of all agents into frame sets, in the order of capture time. Frames are of one instant when they
// are nearer to each other than to the next of any camera in the set, by how often its frames come, which is measured.
// Live, a set waits for an agent as long as its link usually takes, and the deadline more. Pure: the time comes as an
// argument.
class FrameSetSync {
 public:
  explicit FrameSetSync(const SyncConfig& config) : config_(config) {}

  // rate_hz: until a few frames were used. lockstep: this agent's frames are waited for as long as it takes.
  void add(CameraId camera, double rate_hz, bool lockstep);
  // Sets are numbered on from this one.
  void begin_after(SetId set) { next_set_ = set.value + 1; }
  // Marks a camera that will send no more; frames that it sent are still used.
  void finish(CameraId camera);
  // Stops waiting for a camera until it sends again.
  void set_silent(CameraId camera);

  // Adds a frame; false when it is older than the last set made (too late to use).
  bool push(CameraFrame frame, TimeNs now_ns);
  // The next set when everyone who is waited for is there, or the deadline has passed.
  std::optional<FrameSet> pop(TimeNs now_ns);

  // Cameras that the next set waits for.
  std::vector<CameraId> blocking() const;
  // Older frames are too late.
  std::optional<TimeNs> past_ns() const { return last_t_ns_; }
  std::uint32_t late() const { return late_; }
  std::uint32_t overflowed() const { return overflowed_; }

 private:
  struct Waiting {
    CameraFrame frame;
    TimeNs arrived_ns = 0;
  };
  struct Member {
    bool lockstep = false, finished = false, silent = false;
    TimeNs period_ns = 0;
    std::optional<TimeNs> newest_ns;   // capture time of the newest frame that was used
    std::deque<TimeNs> steps_ns;       // between the last of them
    TimeNs lag_ns = 0, lag_at_ns = 0;  // recent maximum of the time from capture to arrival of its frames
    std::deque<Waiting> queue;
  };

  bool overdue(const Waiting& oldest, TimeNs since_ns, TimeNs now_ns) const;
  TimeNs tolerance_ns(TimeNs period_ns) const;
  std::vector<CameraFrame> take_instant(TimeNs first_ns);
  static CameraFrame take_head(Member& m);

  SyncConfig config_;
  std::map<CameraId, Member> members_;
  std::uint32_t next_set_ = 0;
  std::optional<TimeNs> last_t_ns_;  // oldest frame of the last set
  TimeNs last_set_ns_ = std::numeric_limits<TimeNs>::min();
  std::uint32_t late_ = 0, overflowed_ = 0;
};

}  // namespace coslam
