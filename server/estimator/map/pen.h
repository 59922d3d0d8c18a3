// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/map/journal.h"
#include "server/estimator/map/map.h"

// Verbs that write the map are defined in classes that build on each other (track_pen.h, point_pen.h, camera_pen.h,
// lens_pen.h, maps_pen.h, past_pen.h, session_pen.h), where they are protected: keys.h says who may call which of them.
namespace coslam {

// Base of all verbs, with a map and its journal. The verbs keep the map's invariants: a track and its point name each
// other, key observations are sorted and unique, the indices behind Map's queries hold. Entities are named by
// references to the map's own, as Map gives them out. Thread-compatible.
class MapPen {
 public:
  const Map& map() const { return map_; }

 protected:
  // Needed by C++ alone, because keys are virtual bases of MapEdit, which calls the other constructor.
  MapPen() : map_({}) {}
  explicit MapPen(const MapConfig& config) : map_(config) {}

  // Give write access to what Map gave out as const; only verbs use them.
  MapCamera& mutable_camera(CameraId id) { return map_.cameras_[id.value]; }
  MapCamera& mutable_camera(const MapCamera& camera) { return mutable_camera(camera.id); }
  static ServerTrack& mutable_track(const ServerTrack& track) {
    return const_cast<ServerTrack&>(track);  // NOLINT: ours
  }
  static MapPoint& mutable_point(const MapPoint& point) {
    return const_cast<MapPoint&>(point);  // NOLINT: ours
  }
  MapPoint* mutable_point(PointId id) { return map_.points_.by_id.find(id); }
  ServerTrack& mutable_track(const BoundTrack& b) { return mutable_camera(b.camera).tracks.at(b.track); }

  Event event(EventKind kind, Why why, Figures figures = {}) const;
  void note_point(EventKind kind, const MapPoint& point, Why why, Figures figures = {});
  void note_track(EventKind kind, CameraId camera, const ServerTrack& track, Why why, Figures figures = {});
  void note_camera(EventKind kind, const MapCamera& camera, Why why, Figures figures = {});

  // Marks the point as seen now.
  void touch(MapPoint& point);
  // Adds a key observation to a point. A track may come back to a point, or its point be fused with one that it was
  // bound to before: each observation is there once.
  void observe(MapPoint& point, const KeyObservation& seen);

  Map map_;
  Journal journal_;
};

}  // namespace coslam
