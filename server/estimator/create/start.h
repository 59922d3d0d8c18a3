// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/workers.h"
#include "server/estimator/adjust/refine.h"
#include "server/estimator/map/keys.h"
#include "server/estimator/pose/localise.h"
#include "server/estimator/solve/start.h"

namespace coslam {

struct StartStageConfig {
  StartConfig pair;
  double alone_after_s = 0.27;  // time after which a camera without a map tries to start one from its own motion
  double min_flow_px = 16;      // least median displacement of its tracks for that, at 640 px image width
};

template <class V>
void describe(V& v, StartStageConfig& c) {
  v.field("min_matches", c.pair.min_matches, {10, 1000}, "between two cameras that start a map together");
  v.field("min_parallax_rad", c.pair.min_parallax_rad, {0.001, 1}, "median over their points");
  v.field("alone_after_s", c.alone_after_s, {0, 1000},
          "after so long a camera that nobody placed starts a map of its own");
  v.field("min_flow_px", c.min_flow_px, {1, 200}, "median displacement of its tracks for that, at 640 px image width");
}

struct StartReport {
  int started = 0;
  std::string reason;  // reason of a failed start

  void count(auto&& add) const { add("maps_started", started); }
};

// Starts maps. Cameras with enough common view start one together (paper: all see one scene), by the descriptors of
// their tracks: an agent describes its first image, and later ones when asked. Answers take time, so one is remembered
// as long as its camera has no map, and the positions are those of this set, at which the tracks still live. A camera
// that stays alone starts a map of its own from its own motion, with a scale of its own. place_recognition.h joins
// them.
class Start {
 public:
  static constexpr std::string_view kName = "start";
  using Config = StartStageConfig;
  explicit Start(const Config& stage_config) : config(stage_config) {}
  Config config;

  StartReport run(StartEdit& edit, const FrameSet& set, const LocaliseConfig& localise,
                  const BundleAdjustmentConfig& refine, Workers& workers = Workers::alone());

 private:
  void remember(const Map& map, const FrameSet& set);
  // Cameras without a map: their number, and those that are in the set and were described. A camera that is not in the
  // set, being busy with its answer, is waited for too.
  struct Unplaced {
    int cameras = 0;
    std::vector<CameraId> described = {};
    bool some_silent() const { return cameras > 1 && cameras > static_cast<int>(described.size()); }
  };
  Unplaced unplaced(const Map& map, const FrameSet& set) const;
  bool together_now(const Map& map, const Unplaced& cameras);

  std::map<CameraId, DescriptorReply> described_;
  std::optional<SetId> waiting_since_;  // a description came since the last try
  // True when that try left a camera over with descriptions of different sets: too few of their tracks may have been
  // left, and answers to come may tell more.
  bool may_yet_start_ = false;
};

}  // namespace coslam
