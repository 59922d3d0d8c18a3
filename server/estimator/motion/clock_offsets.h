// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <tuple>
#include <vector>

#include "server/estimator/map/keys.h"
#include "server/estimator/solve/clock_offset.h"

namespace coslam {

struct ClockOffsetsConfig {
  bool enabled = true;
  double period_s = 1.0;    // time between estimates
  double memory_s = 60;     // age up to which observations count
  double significance = 4;  // sigmas that an offset has to be from 0 to be used
};

template <class V>
void describe(V& v, ClockOffsetsConfig& c) {
  v.field("enabled", c.enabled, "estimate the offsets of the agents' clocks from what moves");
  v.field("period_s", c.period_s, {0.01, 1000}, "between estimates");
}

struct ClockOffsetsReport {
  bool estimated = false;
};

// Estimates the offsets of the agents' clocks from moving points that two cameras see: an image that is dated wrongly
// shows them off the epipolar line of the other camera, by their speed across it. A significant offset is put into the
// map (MapCamera::clock_offset_ns), where everything that brings observations to one instant uses it.
class ClockOffsets {
 public:
  static constexpr std::string_view kName = "clock_offsets";
  using Config = ClockOffsetsConfig;
  explicit ClockOffsets(const ClockOffsetsConfig& stage_config) : config(stage_config) {}
  ClockOffsetsConfig config;

  ClockOffsetsReport run(ClockOffsetsEdit& edit);
  // Forgets a camera, whose clock is another one from now on.
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
  void estimate(ClockOffsetsEdit& edit);

  std::map<Pair, Stretch> open_;        // still growing
  std::map<Pair, std::uint32_t> next_;  // next set to be looked at
  std::deque<Stretch> stretches_;
  std::vector<ClockOffset> offsets_;
};

}  // namespace coslam
