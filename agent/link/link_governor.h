// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "agent/link/agent_link.h"
#include "agent/link/reply_rate.h"
#include "agent/link/send_rate.h"
#include "common/base/time.h"

namespace coslam {

// Sends no more than the link carries: which frames are sent, and how much may be answered with one, by how long frames
// and replies are under way. Pure: time is an argument.
class LinkGovernor {
 public:
  // How much may be answered with a frame.
  struct Room {
    std::optional<std::size_t> patches;  // empty: as many as were asked for
    std::optional<int> features;         // most features of an image that is described; empty: all
  };

  explicit LinkGovernor(double rate_hz) : rate_hz_(rate_hz), send_rate_(rate_hz) {}

  // Whether the image that was taken then is to be sent.
  bool due(TimeNs capture_ns) { return send_rate_.due(capture_ns); }
  // Notes a frame that was given to the link. delay_s: between image and link, which is no fault of the link's.
  void sent(FrameId frame, Instant at, double delay_s, double sent_reply_bytes);
  // Learns from the patches that arrived, and says what replies may take from now on.
  ReplyLimits heard(const std::vector<MapPatch>& patches, bool replies_wait, bool server_alive, Instant now);
  // On a link that carries little an image is described in no more features than get through in about a second: later
  // its tracks are others.
  Room room() const;

  // The link carries fewer frames than there are.
  bool thins_frames() const { return send_rate_.narrow(); }
  // The link carries little, of frames or of replies, or did so lately.
  bool narrow() const { return narrow_; }
  // The newest frame that was given to the link.
  std::optional<FrameId> newest_sent() const;

 private:
  struct Sent {
    FrameId frame;
    Instant at;
    double delay_s = 0;
    double reply_bytes = 0;  // size of the replies sent by then
  };
  Sent sent_with(FrameId frame, Instant now) const;
  double bytes_a_frame() const;

  double rate_hz_;
  SendRate send_rate_;
  ReplyRate reply_rate_;
  double delivered_bytes_ = 0;   // size of the delivered replies
  std::optional<Instant> full_;  // when replies last waited for a link that carries little
  std::deque<Sent> sent_;        // the last frames
  bool narrow_ = false;
};

}  // namespace coslam
