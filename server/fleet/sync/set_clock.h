// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "common/model/session.h"
#include "server/fleet/sync/backlog.h"
#include "server/fleet/sync/frame_set_sync.h"
#include "server/fleet/sync/stamp_watch.h"

namespace coslam {

// Makes frame sets of the frames of all agents: brings their stamps onto one time, and leaves out, in real time, sets
// for which the server is too slow. As soon as one agent plays in lock-step, stamps are taken as they are and every set
// is used. Pure: time is an argument. Thread-compatible.
class SetClock {
 public:
  // utc_at_zero_ns: what frames of cameras should be dated when they arrive at the server's time 0.
  SetClock(const SyncConfig& config, TimeNs utc_at_zero_ns) : sync_(config), stamps_({utc_at_zero_ns}) {}

  // Adds another expected stamp of frames that arrive at the server's time 0; see StampWatch::expect().
  void expect(TimeNs at_zero_ns) { stamps_.expect(at_zero_ns); }
  // Sets are numbered on from this one.
  void begin_after(SetId set) { sync_.begin_after(set); }

  void add(CameraId camera, const Hello& hello);
  void exchange(CameraId camera, const ClockExchange& stamps) { stamps_.exchange(camera, stamps); }
  // A camera that is not waited for until it sends again. In lock-step it is waited for all the same.
  void set_silent(CameraId camera);
  // A camera that sends no more; what it sent is still used.
  void finish(CameraId camera) { sync_.finish(camera); }

  // Brings a frame's stamp onto the common time; arrived_ns: at this server. False: the frame is not to be used.
  bool date(CameraFrame* frame, TimeNs arrived_ns);
  struct Pushed {
    bool in_time = false;    // false: older than the last set made
    bool displaced = false;  // too many waited, so that an older frame of the camera was thrown away
  };
  Pushed push(CameraFrame frame, TimeNs now_ns);
  // The next set to work on, oldest first. most: how many may wait in real time; `leave_out` is called for each of
  // those that were one too many.
  std::optional<FrameSet> next(TimeNs now_ns, std::size_t most, const std::function<void(const FrameSet&)>& leave_out);
  // A set of those that wait, whatever their number.
  std::optional<FrameSet> next_waiting() { return backlog_.pop(); }

  bool lockstep() const { return lockstep_; }
  bool waiting() const { return !backlog_.empty(); }
  // How much longer than at best the camera's newest frame was under way; 0 in lock-step.
  double wait_s(CameraId camera) const { return lockstep_ ? 0 : stamps_.wait_s(camera); }
  // Frames that are older are too late.
  std::optional<TimeNs> past_ns() const { return sync_.past_ns(); }
  const StampWatch& stamps() const { return stamps_; }
  std::uint32_t late() const { return sync_.late(); }
  std::uint32_t overflowed() const { return sync_.overflowed(); }
  std::uint32_t sets_left_out() const { return left_out_; }
  // Sentences for the log since the last call.
  std::vector<std::string> take_warnings() { return stamps_.take_warnings(); }

 private:
  FrameSetSync sync_;
  StampWatch stamps_;
  Backlog backlog_;
  std::uint32_t left_out_ = 0;
  bool lockstep_ = false;
};

}  // namespace coslam
