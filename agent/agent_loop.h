// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "agent/agent.h"
#include "agent/capture/image_check.h"
#include "agent/describer.h"
#include "agent/feed.h"
#include "agent/link/agent_link.h"
#include "agent/link/link_governor.h"
#include "agent/state_words.h"
#include "common/model/session.h"

namespace coslam {

// One agent's step thread: images from the feed, patches from the link, frames to the link. Live it never waits for the
// server, and describes images beside; in lock-step the patch that answers frame n comes before frame n + 1 is finished
// (its tracking runs meanwhile), and its descriptors go with it.
class AgentLoop {
 public:
  using Clock = std::function<std::chrono::steady_clock::time_point()>;

  AgentLoop(AgentLink& link, std::unique_ptr<Feed> feed, const Hello& hello, const AgentConfig& config);
  // Uses another tracker and another clock than an agent's process does.
  AgentLoop(AgentLink& link, std::unique_ptr<Feed> feed, const Hello& hello, const AgentConfig& config,
            std::unique_ptr<FeatureTracker> tracker, Clock now = std::chrono::steady_clock::now);

  // The stamps of its images are of this machine's clock: the server may correct them.
  void stamps_are_utc() { stamps_are_utc_ = true; }

  // Sends no more than the link carries (live; images come as fast as time).
  void adapt_to_link() { adapts_ = true; }

  // Says in the log when the server falls silent or is back, and when the pose is lost or found; as one of several
  // agents of this process, with its name before it. One that has the process for itself reports all its warnings.
  enum class LogsAs { kProcess, kOneOfSeveral };
  void log_state(LogsAs logs_as = LogsAs::kProcess) { logs_as_ = logs_as; }
  // Sets the position in the source where it begins, for the report.
  void plays_from(double start_s) { start_s_ = start_s; }

  // Processes one image; false at the end of the feed, and in lock-step when the server stops. stop: give up waiting.
  // Throws UserError when the server is gone in lock-step or turned this agent away.
  bool step(const std::atomic<bool>& stop);
  // Tells the server that this agent has ended, with its report and what its last image shows.
  void finish(const std::atomic<bool>& stop);

 private:
  void judge(const Image& image);
  void tell_state();
  std::vector<MapPatch> collect_patches(const std::atomic<bool>& stop);
  bool server_stops() const;
  Answers answers() const;
  bool describing() const { return described_ || (describer_ && describer_->busy()); }
  void take_described();
  void warn_when_slow();
  void say_state();
  void say(const std::string& text) const;
  void warn(const std::string& text) const;
  void throw_if_refused() const;
  AgentStatus status(AgentState state) const;
  std::uint32_t not_sent() const { return feed_->dropped() + frames_ - sent_frames_; }
  void answer_who_looks(const Image& image);
  std::uint32_t left_out() const;
  std::optional<DescriptorReply> last_image();
  std::string report() const;

  AgentLink& link_;
  std::unique_ptr<Feed> feed_;
  Hello hello_;
  Agent agent_;
  Clock now_;
  LinkGovernor governor_;
  std::optional<FrameId> last_sent_;
  std::optional<TrackFrame> not_sent_;  // the newest, on a link that does not carry all
  double start_s_ = 0;
  bool stamps_are_utc_ = false, adapts_ = false;
  std::optional<LogsAs> logs_as_;
  StateWords words_;
  std::optional<Describer> describer_;        // live
  std::optional<DescriptorReply> described_;  // to be sent with the next frame
  StageTimes times_;                          // beside the agent's own
  ClockExchange exchange_;                    // begun by the newest patch
  std::uint32_t frames_ = 0, sent_frames_ = 0;
  ImageVerdict verdict_;
  std::array<std::uint32_t, kImageFaults> left_out_{};  // images
  std::uint32_t repeated_ = 0;                          // images, not counting those of a picture that stands
  bool pattern_stays_ = false;
  TimeNs clock_set_ns_ = 0;
  std::optional<std::chrono::steady_clock::time_point> last_status_, last_thumbnail_;
  const bool gives_thumbnails_;
  PoseState last_pose_state_ = PoseState::kNone;
  ImageFault last_verdict_ = ImageFault::kNone;
};

}  // namespace coslam
