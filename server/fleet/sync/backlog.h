// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "server/estimator/map/map.h"

namespace coslam {

// Live: the frame sets that there was no time for yet. Where there are too many, those are left out whose cameras had
// the most sets in the last second or so: who sends more than the others pays for it first, and among equals the oldest
// go, one in so many, since each set takes as long as the others.
class Backlog {
 public:
  void push(FrameSet set) { waiting_.push_back(std::move(set)); }
  // Leaves out all but so many, and gives those. What an agent was asked for rides with its next frame.
  std::vector<FrameSet> thin(std::size_t most);
  // The next to work on, oldest first.
  std::optional<FrameSet> pop();
  bool empty() const { return waiting_.empty(); }

 private:
  struct Served {
    double sets = 0;  // decaying count of sets
    TimeNs at_ns = 0;
  };
  double served(CameraId camera, TimeNs now_ns) const;
  double least_served(const FrameSet& set) const;  // minimum of served() over the cameras of the set

  std::deque<FrameSet> waiting_;
  std::map<CameraId, Served> served_;
};

}  // namespace coslam
