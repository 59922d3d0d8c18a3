// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "server/keep/explain/life.h"

namespace coslam::explain {

// Events of a run by hand, one frame set a tenth of a second, and the lives that they tell.
class Story : public ::testing::Test {
 protected:
  Story() : cam0_(log_.camera_named("cam0")), cam1_(log_.camera_named("cam1")) {}

  Event& at(double t_s, EventKind kind, Why why, Figures figures = {}) {
    Event e;
    e.t_ns = to_ns(t_s);
    e.set = SetId(static_cast<std::uint32_t>(t_s * 10 + 0.5));
    e.kind = kind;
    e.why = why;
    e.figures = figures;
    story_.push_back(e);
    return story_.back();
  }
  void made(double t_s, int point, PointPhase phase, Why why, Figures figures = {}, int map = 1) {
    Event& e = at(t_s, EventKind::kPointMade, why, figures);
    e.point = id<PointId>(point);
    e.map = id<MapId>(map);
    e.to = static_cast<std::uint8_t>(phase);
  }
  void became(double t_s, int point, PointPhase phase, Why why, Figures figures = {}) {
    Event& e = at(t_s, EventKind::kPointBecame, why, figures);
    e.point = id<PointId>(point);
    e.to = static_cast<std::uint8_t>(phase);
  }
  void fused(double t_s, int kept, int gone) {
    Event& e = at(t_s, EventKind::kPointFused, Why::kOneCorner, {0.5, 0.925});
    e.point = id<PointId>(kept);
    e.other = id<PointId>(gone);
  }
  void removed(double t_s, int point, Why why, Figures figures = {}) {
    at(t_s, EventKind::kPointRemoved, why, figures).point = id<PointId>(point);
  }
  Event& track(double t_s, EventKind kind, CameraId camera, int track, int point, Why why, Figures figures = {}) {
    Event& e = at(t_s, kind, why, figures);
    e.camera = camera;
    e.track = id<TrackId>(track);
    e.point = id<PointId>(point);
    return e;
  }
  Event& camera(double t_s, EventKind kind, int map, Why why, Figures figures = {}) {
    Event& e = at(t_s, kind, why, figures);
    e.camera = cam0_;
    e.map = id<MapId>(map);
    return e;
  }
  Event& map(double t_s, EventKind kind, int map, Why why, Figures figures = {}) {
    Event& e = at(t_s, kind, why, figures);
    e.map = id<MapId>(map);
    return e;
  }

  std::string point(int point) { return life_text(log(), *life_of_point(log(), id<PointId>(point))); }
  std::string point_at(int point, double t_s) {
    return told_at(log(), *life_of_point(log(), id<PointId>(point)), to_ns(t_s));
  }
  std::string track_of(CameraId camera, int track) {
    return life_text(log(), *life_of_track(log(), {camera, id<TrackId>(track)}));
  }
  std::string track_at(CameraId camera, int track, double t_s) {
    return told_at(log(), *life_of_track(log(), {camera, id<TrackId>(track)}), to_ns(t_s));
  }
  const EventLog& log() {
    for (; added_ < story_.size(); ++added_) log_.add(story_[added_]);
    return log_;
  }

  EventLog log_;
  CameraId cam0_, cam1_;

 private:
  template <class IdType>
  static IdType id(int value) {
    return IdType(static_cast<std::uint32_t>(value));
  }
  std::vector<Event> story_;
  std::size_t added_ = 0;
};

}  // namespace coslam::explain
