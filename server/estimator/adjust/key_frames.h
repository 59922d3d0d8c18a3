// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>

#include "common/base/workers.h"
#include "server/estimator/adjust/bundle_adjustment.h"
#include "server/estimator/map/keys.h"
#include "server/estimator/reports/place_recognition_report.h"

namespace coslam {

struct KeyFramesConfig {
  double drop = 0.30;   // share of a camera's points lost since its last key frame (paper)
  double max_s = 0.67;  // longest time between key frames while any camera moves
};

template <class V>
void describe(V& v, KeyFramesConfig& c) {
  v.field("keyframe_drop", c.drop, {0.01, 1}, "of a camera's points since the last key frame");
  v.field("max_s", c.max_s, {0.01, 1000}, "between key frames while a camera moves");
}

// Decides on a key frame: when any camera lost 30 % of the points it had at its last one, or moved for long (paper 4).
// Where there are more than a few cameras, one of them needs a key frame all the time, and the others are spared until
// they do. Returns true when the set became one.
bool decide_key_frame(KeyFramesEdit& edit, const FrameSet& set, const KeyFramesConfig& config);

struct KeyFramesReport {
  bool key_frame = false, planned = false;
  void count(auto&& add) const { add("refinements", planned); }
};

// Decides whether the set is a key frame, and what is adjusted then: the newest key frames of one map, each map in
// turn; or the outline of a map that was joined or had a loop closed, or of each map in turn when there are a quarter
// more key frames: so the map is corrected while it is small, and lens errors are found.
class KeyFrames {
 public:
  static constexpr std::string_view kName = "key_frames";
  using Config = KeyFramesConfig;
  explicit KeyFrames(const KeyFramesConfig& stage_config) : config(stage_config) {}
  KeyFramesConfig config;

  KeyFramesReport run(KeyFramesEdit& edit, const FrameSet& set, const BundleAdjustmentReport& taken,
                      const PlaceRecognitionReport& met, const BundleAdjustmentConfig& refine, Workers& workers);
  // Returns the job that the last set planned; it is in flight until its solution was applied.
  std::optional<RefineJob> take_job();

 private:
  bool outline_is_due(const Map& map, MapId map_id, const BundleAdjustmentConfig& refine);
  bool zooms_are_due(const Map& map, MapId map_id, const BundleAdjustmentConfig& refine);
  bool plan_job(const Map& map, bool key_frame, const BundleAdjustmentConfig& refine, Workers& workers);

  std::optional<RefineJob> planned_;
  bool in_flight_ = false;
  MapId outline_;  // map whose outline is to be adjusted; 0 = none
  SetId outline_since_;
  int plans_ = 0;
  std::map<MapId, std::size_t> zooms_due_;  // number of key frames at which focus breathing is next tested
  std::map<MapId, std::size_t> due_;        // number of key frames at which a map's outline is next adjusted
};

}  // namespace coslam
