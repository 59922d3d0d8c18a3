// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/base/ids.h"
#include "common/model/track_frame.h"

namespace coslam {

// Image coordinates in units of 1 / pixel_scale(camera) pixel; on the wire within +-kMostUnits.
struct Units {
  std::int32_t x = 0, y = 0;
  friend bool operator==(const Units&, const Units&) = default;
};
constexpr std::int32_t kMostUnits = 32767;

// The tracks of a frame as the wire has them.
struct CodedTrack {
  std::uint32_t track = 0;
  Units at;
};
using CodedTracks = std::vector<CodedTrack>;  // ascending
CodedTracks coded_tracks(const TrackFrame& frame, double px_scale);

// An earlier frame that both ends hold; without tracks there is none.
struct TrackReference {
  FrameId frame;
  const CodedTracks* tracks = nullptr;
};

}  // namespace coslam
