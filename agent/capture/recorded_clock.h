// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/base/time.h"

namespace coslam {

// Times of an image in a recording.
struct RecordedTime {
  TimeNs stamp_ns = 0;  // when the camera took it, of its own clock; 0: it does not say
  TimeNs noted_ns = 0;  // when the recorder received it
};

// Choice of the times of a recorded topic's images, and their zero.
struct RecordedClock {
  bool by_stamps = true;
  TimeNs zero_ns = 0;
  std::vector<std::string> guesses;  // sentences for the user

  TimeNs source_ns(const RecordedTime& t) const { return (by_stamps ? t.stamp_ns : t.noted_ns) - zero_ns; }
};

// Chooses by a topic's first images. Stamps count, unless most images have none or the same as another, or they make no
// camera's rate and the times at which they were received do. Images count from the start of the recording, so that
// those of several topics keep their time. Stamps that are far from when they were noted are of another clock, and
// count from their own first.
RecordedClock recorded_clock(const std::string& name, const std::vector<RecordedTime>& first, TimeNs recording_ns);

}  // namespace coslam
