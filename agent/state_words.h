// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/base/time.h"
#include "common/model/image_fault.h"
#include "common/model/track_frame.h"

namespace coslam {

// Sentences for the log about an agent's server, link and pose: one at each change, none about what is over within half
// a second. Pure: time is an argument. Thread-compatible.
class StateWords {
 public:
  // Sentence on the server, to be asked once a frame.
  std::optional<std::string> server(bool alive, Instant now) { return server_.note(alive, now); }
  std::optional<std::string> pose(PoseState state, Instant now) {
    return pose_.note(state == PoseState::kTracked, now);
  }
  std::optional<std::string> link(bool carries_all, Instant now) { return link_.note(carries_all, now); }
  // Whether its images are to be believed, when that changes.
  std::optional<std::string> images(ImageFault verdict);
  // Says once that the images alternate between settings.
  std::optional<std::string> alternating(bool left_out_some);
  // Says once that many images repeat the one before.
  std::optional<std::string> repeating(std::uint32_t repeats, std::uint32_t fresh_images);
  // Says once that a pattern stays in the picture.
  std::optional<std::string> fixed_pattern(bool found);
  // Says how much of the picture moves with the camera, when that was found.
  std::optional<std::string> own_body(double share);
  // The time of day was set, when that changes.
  std::optional<std::string> clock(TimeNs set_ns);
  // The width that its images are tracked at, when it changes.
  std::optional<std::string> working_width(int width_px);
  // The readout of its camera as it is found out, 0 while it is not; again when it turns out a third different.
  std::optional<std::string> readout(double readout_s);

 private:
  // Something that is there or is not; nothing is said before it was there for the first time.
  class Presence {
   public:
    Presence(const char* first, const char* lost, const char* back) : first_(first), lost_(lost), back_(back) {}
    std::optional<std::string> note(bool present, Instant now);

   private:
    const char *first_, *lost_, *back_;
    bool was_there_ = false, said_lost_ = false;
    std::optional<Instant> gone_since_;
  };

  Presence server_{nullptr, "the map server is silent; going on alone", "the map server is back"};
  Presence pose_{"has a pose in the map", "lost: no pose in the map", "found again: has a pose in the map"};
  Presence link_{nullptr, "the link does not carry all frames; sending fewer", "the link carries all frames again"};
  ImageFault said_fault_ = ImageFault::kNone;
  bool said_alternating_ = false, said_repeating_ = false, said_pattern_ = false;
  double said_body_ = 0;
  TimeNs said_set_ns_ = 0;
  int said_width_px_ = 0;
  double said_readout_s_ = 0;
};

}  // namespace coslam
