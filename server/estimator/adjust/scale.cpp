// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/scale.h"

namespace coslam {

// A map that cameras of a rig came into from elsewhere has another unit until two of them have a pose in it.
void Scale::scale_by_rigs(ScaleEdit& edit) {
  const Map& map = edit.map();
  for (const MapCamera& a : map.cameras()) {
    if (a.rig.empty() || a.frames.empty() || !a.frames.back().valid() || map.is_metric(a.map)) continue;
    for (const CameraId id : map.rig_mates(a)) {
      const MapCamera& b = map.camera(id);
      const FramePose* fb = b.frame_at(a.frames.back().set);
      if (fb == nullptr || fb->map != a.map) continue;
      const FramePose& fa = a.frames.back();
      const double length = (fa.cam_from_world.center() - fb->cam_from_world.center()).norm();
      const double truth_m = (b.cam_from_rig * a.cam_from_rig.inverse()).translation.norm();
      if (!(length > 0)) continue;
      if (!rig_doubts_.agrees(map, a, b, fb->cam_from_world * fa.cam_from_world.inverse())) continue;
      edit.transform(a.map, {truth_m / length, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()},
                     Why::kScaleKnown);
      edit.set_metric(a.map);
      break;
    }
  }
}

ScaleReport Scale::by_rigs(const Map& map) {
  for (const MapCamera& c : map.cameras()) {
    if (map.is_metric(c.map)) metric_.insert(c.map);
  }
  return {.in_metres = metric_, .doubts = rig_doubts_.take(map)};
}

ScaleReport Scale::run(ScaleEdit& edit, const FrameSet& set, const PlaceRecognitionReport& met) {
  if (!edit.map().config().rigs.empty()) {
    scale_by_rigs(edit);
    return by_rigs(edit.map());
  }
  if (config.baseline_m > 0) {
    scale_by_baseline(edit);
    return by_baseline();
  }
  return config.tags.side_m > 0 ? by_tags(tags_.step(edit, set, met.merged > 0)) : by_earlier_runs();
}

// The poses that tell the scale are known better now.
ScaleReport Scale::finish(ScaleEdit& edit) {
  if (!edit.map().config().rigs.empty()) return by_rigs(edit.map());
  if (config.baseline_m <= 0 && config.tags.side_m <= 0) return by_earlier_runs();
  if (config.baseline_m <= 0) return by_tags(tags_.finish(edit));
  scaled_ = MapId();
  scale_by_baseline(edit);
  return by_baseline();
}

ScaleReport Scale::by_baseline() const {
  ScaleReport report;
  if (scaled_ != MapId()) report.in_metres = {scaled_};
  return report;
}

// Of a map that goes on, when this run knows no lengths itself.
ScaleReport Scale::by_earlier_runs() const {
  ScaleReport report{.in_metres = metric_};
  report.in_metres.merge(tags_.in_metres());
  if (scaled_ != MapId()) report.in_metres.insert(scaled_);
  return report;
}

ScaleReport Scale::by_tags(const TagScaleReport& r) const {
  return {.in_metres = tags_.in_metres(), .measured = r.measured, .scaled = r.scaled, .doubts = r.doubts};
}

// The first instant at which the first two cameras have a pose in the same map tells its scale; again when that map
// became part of another, whose scale is its own.
void Scale::scale_by_baseline(ScaleEdit& edit) {
  const Map& map = edit.map();
  if (map.cameras().size() < 2) return;
  const MapCamera &a = map.cameras()[0], &b = map.cameras()[1];
  if (scaled_ != MapId() && a.frame_at(scaled_at_)->map == scaled_) return;
  for (const FramePose& fa : a.frames) {
    const FramePose* fb = b.frame_at(fa.set);
    if (!fa.valid() || fb == nullptr || fb->map != fa.map) continue;
    const double length = (fa.cam_from_world.center() - fb->cam_from_world.center()).norm();
    if (length <= 0) return;
    scaled_ = fa.map;
    scaled_at_ = fa.set;
    edit.transform(fa.map, {config.baseline_m / length, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()},
                   Why::kScaleKnown);
    return;
  }
}

}  // namespace coslam
