// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/estimator/adjust/rig_doubts.h"
#include "server/estimator/adjust/tag_scale.h"
#include "server/estimator/map/keys.h"
#include "server/estimator/reports/place_recognition_report.h"
#include "server/estimator/reports/scale_report.h"

namespace coslam {

struct ScaleConfig {
  double baseline_m = 0;  // known distance of the first two cameras at the start; 0 = unknown, tags may tell the scale
  TagScaleConfig tags;
};

template <class V>
void describe(V& v, ScaleConfig& c) {
  describe(v, c.tags);
}

// Determines the scale of maps, which images alone do not tell: from rigs that the images do not contradict, or else
// from a known baseline, or else from printed tags.
class Scale {
 public:
  static constexpr std::string_view kName = "scale";
  using Config = ScaleConfig;
  explicit Scale(const ScaleConfig& stage_config) : config(stage_config), tags_(stage_config.tags) {}
  ScaleConfig config;

  ScaleReport run(ScaleEdit& edit, const FrameSet& set, const PlaceRecognitionReport& met);
  // Determines the scale at the end of a run, by the final poses.
  ScaleReport finish(ScaleEdit& edit);
  const TagScale& tags() const { return tags_; }
  // Returns frames that are read again, however old they are.
  std::vector<ImageKey> held_frames() const {
    if (scaled_ == MapId()) return {};
    return {{scaled_at_, CameraId(0)}, {scaled_at_, CameraId(1)}};
  }
  // Writes as rows what outlives the server; and reads it.
  void save(std::vector<Row>* rows) const;
  void restore(const Tables& tables);

 private:
  void scale_by_rigs(ScaleEdit& edit);
  ScaleReport by_rigs(const Map& map);
  void scale_by_baseline(ScaleEdit& edit);
  ScaleReport by_baseline() const;
  ScaleReport by_earlier_runs() const;
  ScaleReport by_tags(const TagScaleReport& r) const;

  TagScale tags_;
  RigDoubts rig_doubts_;
  std::set<MapId> metric_;  // metric by rigs; some camera was in each
  MapId scaled_;            // map scaled by the baseline; 0 = none
  SetId scaled_at_;         // instant of the known baseline
};

}  // namespace coslam
