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

// What a camera showed while it had no pose.
struct SeenWithoutPose {
  std::size_t most_tracks = 0;  // in one image
  double most_flow_px = 0;      // median way of its tracks since each began, at 640 px image width
  double longest_s = 0;         // from its first frame to its newest

  void look(const MapCamera& camera);
};

// Of an agent that joined when the others were past the beginning of its recording.
std::string late_images(const std::string& agent, std::uint64_t late, std::uint64_t all, TimeNs past_ns);

// Why none of an agent's images has a pose: the end of a sentence that begins with its name. images: that account;
// faults: how many images were not believed, by fault.
std::string why_no_pose(const ImageAccount& images, const std::array<std::uint64_t, kImageFaults>& faults,
                        const SeenWithoutPose& seen);

}  // namespace coslam
