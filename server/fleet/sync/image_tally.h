// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/model/image_account.h"
#include "common/model/session.h"

namespace coslam {

// Counts what becomes of the images of one agent, by what it says and what arrives. Pure. Thread-compatible.
class ImageTally {
 public:
  // Starts counting for another process of the same name; the counts of the one before remain. heard_of: images from
  // before its first message are not of this run, as of an agent that outlived a server.
  void begin(bool heard_of);
  void heard(const AgentStatus& status);
  // A frame arrived; then one of the others follows.
  void arrived() { ++arrived_; }
  void late() { ++late_; }
  void out_of_time() { ++out_of_time_; }
  void set_left_out() { ++set_left_out_; }
  void used(bool has_pose) { ++(has_pose ? posed_ : unposed_); }

  // The account while the run goes on: by the poses at the time, of images whose fate is known. One with a pose counts
  // as tracked, in whichever map.
  ImageAccount so_far() const;
  // The account when the run is over: by the poses that are in the map. What still waits was left out.
  ImageAccount at_end(std::uint64_t tracked, std::uint64_t in_other_maps) const;

  std::uint64_t frames_posed() const { return posed_; }
  std::uint64_t frames_used() const { return posed_ + unposed_; }
  // Whether no frame that arrived still waits to be used.
  bool all_known() const { return undecided() == 0; }

 private:
  // Counts that one process reports about itself.
  struct Said {
    std::uint64_t sent = 0, not_sent = 0, left_out = 0;
  };
  Said total() const;
  ImageAccount without_used(std::uint64_t arrived) const;
  std::uint64_t undecided() const;

  Said before_, newest_;
  Said base_;                                     // counts of the newest process from before this run, to be subtracted
  bool base_open_ = false;                        // the next word tells it
  std::uint64_t arrived_ = 0, arrived_then_ = 0;  // arrived_then_: value of arrived_ at the newest status
  std::uint64_t late_ = 0, out_of_time_ = 0, set_left_out_ = 0, posed_ = 0, unposed_ = 0;
};

}  // namespace coslam
