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

// Images alone tell no length. Metres come from rigs that the images do not contradict, or else from a known baseline,
// or else from printed tags.
class Scale {
 public:
  static constexpr std::string_view kName = "scale";
  using Config = ScaleConfig;
  explicit Scale(const ScaleConfig& of) : config(of), tags_(of.tags) {}
  ScaleConfig config;

  ScaleReport run(ScaleEdit& edit, const FrameSet& set, const PlaceRecognitionReport& met);
  // By the final poses.
  ScaleReport finish(ScaleEdit& edit);
  const TagScale& tags() const { return tags_; }
  // Frames that it looks at again, however old they are.
  std::vector<ImageKey> held_frames() const {
    if (scaled_ == MapId()) return {};
    return {{scaled_at_, CameraId(0)}, {scaled_at_, CameraId(1)}};
  }
  // What outlives the server, as rows; and back.
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
  std::set<MapId> metric_;  // by rigs, that some camera was in
  MapId scaled_;            // the one that the baseline gave its scale; 0 = none
  SetId scaled_at_;         // the instant of the known baseline
};

}  // namespace coslam
