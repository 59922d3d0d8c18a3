// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <tuple>
#include <vector>

#include "server/map/edit.h"
#include "server/solve/clock_offset.h"

namespace coslam {

struct ClockConfig {
  bool enabled = true;
  int period = 30;             // sets between estimates
  double memory_s = 60;        // of what was seen
  double max_sigma_s = 0.004;  // of an offset that is used
  double significance = 4;     // sigmas from 0 of an offset that is used
};

// Offsets of the agents' clocks, from moving points that two cameras see: an image that is dated wrongly shows them
// off the epipolar line of the other camera, by their speed across it. An offset that is well known is put into the map
// (MapCamera::clock_offset_ns), where everything that brings observations to one instant goes by it.
class ClockFinder {
 public:
  explicit ClockFinder(const ClockConfig& config) : config_(config) {}

  void step(MapEdit& edit, const FrameSet& set);
  // Another clock from now on.
  void forget(CameraId camera);
  ClockOffset offset(CameraId camera) const;

 private:
  using Pair = std::tuple<CameraId, TrackId, CameraId, TrackId>;
  struct Stretch {
    Pair pair;
    TimeNs last_ns = 0;
    ClockStretch seen;
  };
  void observe(const Map& map, const MapPoint& point, const BoundTrack& first, const BoundTrack& second, double weight);
  void close(const Map& map);
  void estimate(MapEdit& edit);

  ClockConfig config_;
  std::map<Pair, Stretch> open_;        // still growing
  std::map<Pair, std::uint32_t> next_;  // set that is still to be looked at
  std::deque<Stretch> stretches_;
  std::vector<ClockOffset> offsets_;
};

}  // namespace coslam
