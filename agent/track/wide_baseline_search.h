// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "agent/track/matcher.h"

namespace coslam {

// Second search for tracks in an image that moved farther than windows can be followed. It rests for some images where
// it was in vain, longer each time: the lens is covered, say. Thread-compatible.
class WideBaselineSearch {
 public:
  // Looks for all tracks where features that look alike say that they went, if hardly any was found, and takes the
  // result if it is more.
  void improve(Matcher& matcher, std::vector<Sought> sought, const Eigen::Vector2f& last_shift_px,
               Following* following);

 private:
  int searches_in_vain_ = 0;  // in succession
  int images_to_rest_ = 0;    // in which another search would be in vain again
};

}  // namespace coslam
