// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "common/model/image_account.h"
#include "common/model/image_fault.h"
#include "server/estimator/map/map.h"

namespace coslam {

// Statistics of a camera while it had no pose.
struct SeenWithoutPose {
  std::size_t most_tracks = 0;  // most tracks in one image
  double most_flow_px = 0;      // largest median displacement of its tracks since each began, at 640 px image width
  double longest_s = 0;         // longest time from its first frame to its newest

  void look(const MapCamera& camera);
};

// Sentence about an agent that joined when the others were past the beginning of its recording.
std::string late_images(const std::string& agent, std::uint64_t late, std::uint64_t all, TimeNs past_ns);

// Reason why none of an agent's images has a pose: the end of a sentence that begins with its name. images: the agent's
// account; faults: number of rejected images, by fault.
std::string why_no_pose(const ImageAccount& images, const std::array<std::uint64_t, kImageFaults>& faults,
                        const SeenWithoutPose& seen);

}  // namespace coslam
